#include "host/error.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/coefficient_formats.hpp"
#include "host/io/coefficient_metadata.hpp"
#include "host/io/csv_table.hpp"
#include "host/io/file_format.hpp"
#include "host/io/number.hpp"
#include "host/io/shown.hpp"
#include "host/sphere_transform.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

std::vector<std::string> real_columns(int fields) {
  std::vector<std::string> columns = {"l", "m"};
  for (int f = 1; f <= fields; ++f)
    for (const char* part : {"C", "S"}) columns.push_back(fields == 1 ? part : fmt::format("{}_{}", part, f));
  return columns;
}

std::vector<std::string> complex_columns(const CoefficientSet& set) {
  if (set.fields == 1) return {"l", "m", "re", "im"};
  std::vector<std::string> columns = {"l", "m"};
  for (const std::string& word : field_names(set.names, set.fields, "field"))
    for (const char* part : {"re", "im"}) columns.push_back(fmt::format("{}_{}", word, part));
  return columns;
}

// The names of fields in complex form, whose columns are l,m,re,im or l,m and NAME_re,NAME_im of each; nothing for other
// columns.
std::vector<std::string> complex_fields(const std::vector<std::string>& columns) {
  if (columns == std::vector<std::string>{"l", "m", "re", "im"}) return {""};
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

Metadata metadata_in(const CsvTable& table) {
  Metadata metadata;
  for (const auto& [key, attribute] : table.attributes) metadata[key] = {attribute.text, attribute.line};
  return metadata;
}

// Those of the body: the mesh's where the table has none.
void take_units(CoefficientSet& set, const Metadata& metadata) {
  const auto unit = [&](const char* key, std::string_view otherwise) {
    return metadata.contains(key) ? metadata.at(key).text : std::string(otherwise);
  };
  set.length_unit = unit("length_unit", mesh_length_unit);
  set.mass_unit = unit("mass_unit", mesh_mass_unit);
}

// What a table of `cowgpu expand` is of: the mass multipoles, the fields of a surface, or all columns.
void choose(CoefficientSet& set, const std::string& of, const CsvTable& table, const Metadata& metadata) {
  const bool mass = set.names[0] == mass_expansion || (set.names[0].empty() && metadata.contains("reference_radius"));
  if (set.names[0].empty()) set.names[0] = mass ? mass_expansion : "";
  const auto starts = [](const std::string& surface) {
    return [surface](const std::string& field) { return field.starts_with(surface + "_"); };
  };
  if (of.empty() || (of == mass_expansion && mass && set.fields == 1)) {
    if (mass && set.fields == 1) {
      set.kind = CoefficientKind::multipoles;
      if (!set.brillouin_radius) set.brillouin_radius = set.reference_radius; // as tables that lack it refer to
      take_units(set, metadata);
    }
    if (mass && set.fields > 1) {
      if (set.reference_radius) set.notes.push_back(expansion_note(metadata.at("reference_radius").text));
      set.reference_radius.reset();
      set.brillouin_radius.reset();
      set.origin.reset();
      set.density.reset();
    }
    return;
  }
  std::vector<int> wanted;
  for (int f = 0; f < set.fields; ++f)
    if (of == mass_expansion ? set.names[std::size_t(f)] == mass_expansion : starts(of)(set.names[std::size_t(f)]))
      wanted.push_back(f);
  if (wanted.empty())
    throw Error(Fault::bad_argument, fmt::format("--of {}: {} has no such expansion; its columns are {}", of,
                                                 table.name, fmt::join(table.columns, ", ")));
  CoefficientSet chosen(set.lmax, int(wanted.size()));
  chosen.form = set.form;
  chosen.provenance = set.provenance;
  for (std::size_t f = 0; f < wanted.size(); ++f) {
    const std::string& field = set.names[std::size_t(wanted[f])];
    chosen.names[f] = of == mass_expansion ? field : field.substr(of.size() + 1);
    if (of != mass_expansion)
      chosen.units[f] = chosen.names[f] == "f_dtheta" || chosen.names[f] == "f_dphi" ? "radian" : "length";
    for (int m = 0; m <= set.lmax; ++m)
      for (int l = m; l <= set.lmax; ++l) {
        chosen.first[chosen.index(int(f), l, m)] = set.first[set.index(wanted[f], l, m)];
        chosen.second[chosen.index(int(f), l, m)] = set.second[set.index(wanted[f], l, m)];
      }
  }
  Metadata own;
  take_units(chosen, metadata);
  if (of == mass_expansion) {
    chosen.kind = CoefficientKind::multipoles;
    for (const char* key : {"reference_radius", "brillouin_radius", "density", "origin"})
      if (metadata.contains(key)) own[key] = metadata.at(key);
  } else {
    chosen.mass_unit.clear();
    if (metadata.contains(of + "_origin")) own["origin"] = metadata.at(of + "_origin");
    for (const auto& [key, text] : metadata)
      if (key.starts_with(of + "_removed_mean_")) chosen.remarks.emplace_back(key.substr(of.size() + 1), text.text);
  }
  take_metadata(own, table.name, chosen);
  if (!chosen.brillouin_radius) chosen.brillouin_radius = chosen.reference_radius;
  set = std::move(chosen);
}

} // namespace

void append_pair(std::string& text, double first, double second, std::string_view separator) {
  append_number(text, first);
  text += separator;
  append_number(text, second);
}

CoefficientSet parse_csv_coefficients(std::string_view bytes, const std::string& name, const std::string& of) {
  const CsvTable table = parse_csv(bytes, name);
  const int fields = int(table.columns.size() / 2) - 1;
  const std::vector<std::string> complex = complex_fields(table.columns);
  if (fields < 1 || fields > most_fields || (complex.empty() && table.columns != real_columns(fields)))
    table.fail(Fault::file_format, table.header_line,
               fmt::format("coefficients have the columns l,m,C,S (several fields, at most {}: l,m,C_1,S_1,C_2,S_2 and "
                           "so on), or l,m,re,im as `cowgpu expand` writes them",
                           most_fields));
  const int lmax = table.integer("lmax", 0, largest_file_degree);
  const Metadata metadata = metadata_in(table);
  CoefficientSet facts(0, fields);
  facts.form = complex.empty() ? Form::real : Form::complex;
  const bool by_expand = !complex.empty() && !metadata.contains("kind") && !metadata.contains("form") &&
                         !metadata.contains("coefficients_of"); // always orthonormal with phase
  if (!take_metadata(metadata, table.name, facts) && !by_expand) {
    table.attribute("normalisation");
    table.attribute("phase");
  }
  if (metadata.contains("coefficients_of") || (!complex.empty() && metadata.contains("form"))) table.attribute("kind");
  if ((facts.form == Form::real) != complex.empty())
    table.fail(Fault::file_syntax, table.header_line, "the line '# form' and the columns say different things");
  // Rows that lie must not make us allocate.
  if (table.rows() < SphereCoefficients::count(lmax)) read_rows(table, lmax, fields, [](auto...) {});
  CoefficientSet set = std::move(facts);
  set.lmax = lmax;
  set.first.resize(std::size_t(fields) * SphereCoefficients::count(lmax));
  set.second.resize(set.first.size());
  read_rows(table, lmax, fields, [&](int f, int l, int m, double first, double second) {
    set.first[set.index(f, l, m)] = first;
    set.second[set.index(f, l, m)] = second;
  });
  if (!complex.empty() && !metadata.contains("fields") && fields > 1) set.names = complex;
  if (!complex.empty() && !metadata.contains("kind"))
    choose(set, of, table, metadata);
  else if (!of.empty() && !(of == mass_expansion && set.kind == CoefficientKind::multipoles))
    throw Error(Fault::bad_argument,
                fmt::format("--of {}: {} holds no expansions to choose from; the .json and .csv of `cowgpu expand` do",
                            of, table.name));
  return set;
}

void write_csv_coefficients(const CoefficientSet& set, AtomicFile& file) {
  const auto columns = set.form == Form::real ? real_columns(set.fields) : complex_columns(set);
  file.write(fmt::format("# cowgpu {}\n{}{}\n", version, comment_lines(set), fmt::join(columns, ",")));
  write_rows(set.lmax, file, [&](std::string& text, int l, int m) {
    text += fmt::format("{},{}", l, m);
    for (int f = 0; f < set.fields; ++f) {
      const std::size_t at = set.index(f, l, m);
      text += ",";
      append_pair(text, set.first[at], set.second[at], ",");
    }
    text += "\n";
  });
}

} // namespace cowgpu
