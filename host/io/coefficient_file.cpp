#include "host/io/coefficient_file.hpp"

#include "host/error.hpp"
#include "host/io/csv_table.hpp"
#include "host/io/expansion_file.hpp"
#include "host/io/netcdf.hpp"
#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/sphere_transform.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace cowgpu {
namespace {

// A file whose numbers fit no double in the orthonormal convention is a bad file, not a bad command line.
SphereCoefficients complex_of(const RealCoefficients& real, const std::string& place) {
  try {
    return to_complex(real);
  } catch (const Error& error) {
    throw Error(Fault::file_format, fmt::format("{}: {}", place, error.what()));
  }
}

std::string_view pyshtools_name(Normalisation normalisation) {
  switch (normalisation) {
  case Normalisation::orthonormal: return "ortho";
  case Normalisation::unnormalised: return "unnorm";
  default: return name(normalisation);
  }
}

std::vector<std::string> columns_of(int fields) {
  std::vector<std::string> columns = {"l", "m"};
  for (int f = 1; f <= fields; ++f)
    for (const char* part : {"C", "S"}) columns.push_back(fields == 1 ? part : fmt::format("{}_{}", part, f));
  return columns;
}

// The names of the fields in the CSV of `cowgpu expand`, whose columns are l,m,re,im or l,m and NAME_re,NAME_im of each;
// nothing for other columns.
std::vector<std::string> expanded_fields(const std::vector<std::string>& columns) {
  if (columns == std::vector<std::string>{"l", "m", "re", "im"}) return {"mass"};
  std::vector<std::string> names;
  if (columns.size() < 4 || columns.size() % 2 != 0 || columns[0] != "l" || columns[1] != "m") return {};
  for (std::size_t i = 2; i < columns.size(); i += 2) {
    const std::string& re = columns[i];
    if (re.size() < 4 || !re.ends_with("_re") || columns[i + 1] != re.substr(0, re.size() - 2) + "im") return {};
    names.push_back(re.substr(0, re.size() - 3));
  }
  return names;
}

// Reads the rows in their fixed order; `take` gets field, l, m and both numbers.
template <class Take>
void read_rows(const CsvTable& table, int lmax, int fields, const Take& take) {
  std::size_t row = 0;
  for (int l = 0; l <= lmax; ++l)
    for (int m = 0; m <= l; ++m, ++row) {
      if (row == table.rows())
        table.fail(Fault::file_truncated, table.first_line + row,
                   fmt::format("the file ends before degree {}, order {}; lmax is {}", l, m, lmax));
      if (table.at(row, 0) != l || table.at(row, 1) != m)
        table.fail_row(
            row, fmt::format("degree {}, order {} expected, found {}, {}", l, m, table.at(row, 0), table.at(row, 1)));
      for (int f = 0; f < fields; ++f) {
        const std::size_t column = 2 + 2 * std::size_t(f);
        if (m == 0 && table.at(row, column + 1) != 0)
          table.fail_row(row, fmt::format("{} of order 0 must be 0", table.columns[column + 1]));
        take(f, l, m, table.at(row, column), table.at(row, column + 1));
      }
    }
  if (row != table.rows()) table.fail_row(row, fmt::format("a row beyond the last one, degree and order {}", lmax));
}

CoefficientFile read_csv_coefficients(const std::filesystem::path& path) {
  const CsvTable table = read_csv(path);
  const int fields = int(table.columns.size() / 2) - 1;
  const std::vector<std::string> expanded = expanded_fields(table.columns);
  if (fields < 1 || fields > most_fields || (expanded.empty() && table.columns != columns_of(fields)))
    table.fail(Fault::file_format, table.header_line,
               fmt::format("coefficients have the columns l,m,C,S (several fields, at most {}: l,m,C_1,S_1,C_2,S_2 and "
                           "so on), or l,m,re,im as `cowgpu expand` writes them",
                           most_fields));
  const int lmax = table.integer("lmax", 0, largest_file_degree);
  CoefficientFile file;
  if (!expanded.empty()) {
    if (expanded[0] == "mass" && table.attributes.contains("reference_radius"))
      file.notes.push_back(expansion_note(table.attribute("reference_radius").text));
    // Rows that lie must not make us allocate.
    if (table.rows() < SphereCoefficients::count(lmax)) read_rows(table, lmax, fields, [](auto...) {});
    file.coefficients = SphereCoefficients(lmax, fields);
    file.names = expanded;
    read_rows(table, lmax, fields, [&](int f, int l, int m, double re, double im) {
      file.coefficients.at(f, l, m) = {re, im};
    });
    return file;
  }
  const auto& normalisation = table.attribute("normalisation");
  const auto& phase = table.attribute("phase");
  const auto n = normalisation_named(normalisation.text);
  const auto p = phase_named(phase.text);
  if (!n)
    table.fail(Fault::file_syntax, normalisation.line,
               fmt::format("normalisation is '{}'; there are orthonormal, 4pi, schmidt and unnormalised",
                           shown(normalisation.text)));
  if (!p)
    table.fail(Fault::file_syntax, phase.line, fmt::format("phase is '{}'; there are cs and none", shown(phase.text)));
  if (table.rows() < SphereCoefficients::count(lmax)) read_rows(table, lmax, fields, [](auto...) {});
  RealCoefficients real(lmax, fields, {*n, *p});
  read_rows(table, lmax, fields, [&](int f, int l, int m, double c, double s) {
    real.cosine[real.index(f, l, m)] = c;
    real.sine[real.index(f, l, m)] = s;
  });
  file.coefficients = complex_of(real, table.name);
  file.convention = real.convention;
  file.names.resize(std::size_t(fields));
  return file;
}

Convention convention_of(const NetcdfVariable& v, const std::string& place) {
  const NetcdfAttribute* normalisation = attribute(v.attributes, "normalization");
  const NetcdfAttribute* phase = attribute(v.attributes, "csphase");
  if (!normalisation || !normalisation->is_text)
    throw Error(Fault::file_syntax, place + ": the attribute normalization is missing or no text");
  if (!phase || phase->is_text)
    throw Error(Fault::file_syntax, place + ": the attribute csphase is missing or no number");
  const auto n = normalisation_named(normalisation->text);
  if (!n)
    throw Error(Fault::file_syntax, fmt::format("{}: normalization is '{}'; there are ortho, 4pi, schmidt and unnorm",
                                                place, shown(normalisation->text)));
  if (phase->number != 1 && phase->number != -1)
    throw Error(
        Fault::file_syntax,
        fmt::format("{}: csphase is {}; it is -1 with the Condon-Shortley phase and 1 without", place, phase->number));
  return {*n, phase->number < 0 ? Phase::condon_shortley : Phase::none};
}

// 0, 1, 2 ... where there are such coordinates.
void check_count(const NetcdfFile& netcdf, const char* key) {
  const NetcdfVariable* v = netcdf.variable(key);
  if (!v || !v->read) return;
  for (std::size_t i = 0; i < v->values.size(); ++i)
    if (v->values[i] != double(i))
      throw Error(Fault::file_syntax,
                  fmt::format("{}: variable {}, value {}: {} where {} belongs", netcdf.name, key, i, v->values[i], i));
}

CoefficientFile read_netcdf_coefficients(const std::filesystem::path& path) {
  const NetcdfFile netcdf = read_netcdf(path);
  if (netcdf.variable("lat") && netcdf.variable("lon"))
    throw Error(Fault::file_format,
                fmt::format("{}: this is a grid, not coefficients; `cowgpu transform analyse` makes "
                            "coefficients of it",
                            netcdf.name));
  CoefficientFile file;
  std::vector<const NetcdfVariable*> fields;
  for (const NetcdfVariable& v : netcdf.variables) {
    if (!v.read || v.dimensions.size() != 2 || netcdf.dimensions[v.dimensions[0]].name != "degree" ||
        netcdf.dimensions[v.dimensions[1]].name != "order")
      continue;
    if (v.name == "errors")
      file.notes.push_back("the variable errors was left out");
    else
      fields.push_back(&v);
  }
  if (fields.empty())
    throw Error(Fault::file_format,
                fmt::format("{}: there is no variable with the dimensions (degree, order)", netcdf.name));
  if (fields.size() > std::size_t(most_fields))
    throw Error(Fault::too_large,
                fmt::format("{}: {} fields; at most {} are possible", netcdf.name, fields.size(), most_fields));
  sort_fields(fields);
  const std::uint64_t n = netcdf.dimensions[fields[0]->dimensions[0]].length;
  if (n < 1 || n > largest_file_degree + 1 || n != netcdf.dimensions[fields[0]->dimensions[1]].length)
    throw Error(Fault::file_format,
                fmt::format("{}: {} degrees and {} orders: both must be lmax + 1, at most {}", netcdf.name, n,
                            netcdf.dimensions[fields[0]->dimensions[1]].length, largest_file_degree + 1));
  check_count(netcdf, "degree");
  check_count(netcdf, "order");
  const int lmax = int(n) - 1;
  RealCoefficients real(lmax, int(fields.size()), {});
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const NetcdfVariable& v = *fields[f];
    const std::string place = fmt::format("{}: variable {}", netcdf.name, shown(v.name));
    const Convention convention = convention_of(v, place);
    if (f > 0 && convention != real.convention)
      throw Error(Fault::file_format, place + ": another convention than the variables before it");
    real.convention = convention;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        const double value = present_value(v, i * n + j);
        if (!std::isfinite(value))
          throw Error(Fault::file_syntax,
                      fmt::format("{}, row {}, column {}: {} is no finite number", place, i, j, value));
        if (j <= i)
          real.cosine[real.index(int(f), int(i), int(j))] = value;
        else
          real.sine[real.index(int(f), int(j), int(i) + 1)] = value;
      }
    const NetcdfAttribute* title = attribute(v.attributes, "title");
    file.names.push_back(title ? title->text : "");
  }
  file.coefficients = complex_of(real, netcdf.name);
  file.convention = real.convention;
  return file;
}

void write_csv_coefficients(const RealCoefficients& real, AtomicFile& file) {
  std::string text = fmt::format("# cowgpu {}\n# lmax {}\n# normalisation {}\n# phase {}\n{}\n", version, real.lmax,
                                 name(real.convention.normalisation), name(real.convention.phase),
                                 fmt::join(columns_of(real.fields), ","));
  for (int l = 0; l <= real.lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      text += fmt::format("{},{}", l, m);
      for (int f = 0; f < real.fields; ++f)
        for (const auto* part : {&real.cosine, &real.sine}) {
          text += ",";
          append_number(text, (*part)[real.index(f, l, m)]);
        }
      text += "\n";
      if (text.size() > 65536) {
        file.write(text);
        text.clear();
      }
    }
  file.write(text);
}

void write_netcdf_coefficients(const RealCoefficients& real, const std::vector<std::string>& names, AtomicFile& file) {
  NetcdfWriter out;
  const auto n = std::size_t(real.lmax) + 1;
  const int dimensions[] = {out.dimension("degree", n), out.dimension("order", n)};
  const int degree = out.variable("degree", NetcdfWriter::Type::integer, std::span(dimensions, 1));
  const int order = out.variable("order", NetcdfWriter::Type::integer, std::span(dimensions + 1, 1));
  std::vector<int> fields;
  for (const std::string& word : field_names({}, real.fields, "coeffs")) {
    const int id = out.variable(word, NetcdfWriter::Type::real, dimensions);
    const std::size_t f = fields.size();
    out.attribute(id, "title", f < names.size() ? names[f] : "");
    out.attribute(id, "description", fmt::format("cowgpu {}", version));
    out.attribute(id, "normalization", pyshtools_name(real.convention.normalisation));
    out.attribute(id, "csphase", std::int64_t(real.convention.phase == Phase::condon_shortley ? -1 : 1));
    fields.push_back(id);
    if (real.fields > 1) out.attribute(id, "field", std::int64_t(fields.size()));
  }
  std::vector<double> row(n);
  for (std::size_t i = 0; i < n; ++i) row[i] = double(i);
  out.values(degree, row);
  out.values(order, row);
  for (int f = 0; f < real.fields; ++f)
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j)
        row[j] = j <= i ? real.cosine[real.index(f, int(i), int(j))] : real.sine[real.index(f, int(j), int(i) + 1)];
      out.row(fields[std::size_t(f)], i, row);
    }
  out.write_to(file);
}

} // namespace

CoefficientFile read_coefficients(const std::filesystem::path& path) {
  if (path.extension() == ".json") return read_expansion(path);
  return file_format(path) == FileFormat::netcdf ? read_netcdf_coefficients(path) : read_csv_coefficients(path);
}

void write_coefficients(const CoefficientFile& coefficients, FileFormat format, AtomicFile& file) {
  const RealCoefficients real = to_real(coefficients.coefficients, coefficients.convention);
  if (format == FileFormat::netcdf)
    write_netcdf_coefficients(real, coefficients.names, file);
  else
    write_csv_coefficients(real, file);
}

} // namespace cowgpu
