#include "host/error.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/coefficient_formats.hpp"
#include "host/io/coefficient_metadata.hpp"
#include "host/io/file_format.hpp"
#include "host/io/length_unit.hpp"
#include "host/io/netcdf.hpp"
#include "host/io/shown.hpp"
#include "host/sphere_transform.hpp"
#include "host/version.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cowgpu {
namespace {

std::string_view pyshtools_name(Normalisation normalisation) {
  switch (normalisation) {
  case Normalisation::orthonormal: return "ortho";
  case Normalisation::unnormalised: return "unnorm";
  default: return name(normalisation);
  }
}

Convention convention_of(const NetcdfVariable& v, const std::string& where) {
  const NetcdfAttribute* normalisation = attribute(v.attributes, "normalization");
  const NetcdfAttribute* phase = attribute(v.attributes, "csphase");
  if (!normalisation || !normalisation->is_text)
    throw Error(Fault::file_syntax, where + ": the attribute normalization is missing or not a text");
  if (!phase || phase->is_text)
    throw Error(Fault::file_syntax, where + ": the attribute csphase is missing or not a number");
  const auto n = normalisation_named(normalisation->text);
  if (!n)
    throw Error(Fault::file_syntax, fmt::format("{}: normalization is '{}'; it must be ortho, 4pi, schmidt or unnorm",
                                                where, shown(normalisation->text)));
  if (phase->number != 1 && phase->number != -1)
    throw Error(
        Fault::file_syntax,
        fmt::format("{}: csphase is {}; it is -1 with the Condon-Shortley phase and 1 without", where, phase->number));
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

std::vector<const NetcdfVariable*> coefficient_variables(const NetcdfFile& netcdf, std::vector<std::string>& notes) {
  std::vector<const NetcdfVariable*> fields;
  for (const NetcdfVariable& v : netcdf.variables) {
    if (!v.read || v.dimensions.size() != 2 || netcdf.dimensions[v.dimensions[0]].name != "degree" ||
        netcdf.dimensions[v.dimensions[1]].name != "order")
      continue;
    if (v.name == "errors")
      notes.push_back("the variable errors was left out");
    else
      fields.push_back(&v);
  }
  if (fields.empty())
    throw Error(Fault::file_format,
                fmt::format("{}: there is no variable with the dimensions (degree, order)", netcdf.name));
  if (fields.size() > std::size_t(most_fields))
    throw Error(Fault::too_large, fmt::format("{}: the file has {} fields; at most {} are possible", netcdf.name,
                                              fields.size(), most_fields));
  sort_fields(fields);
  return fields;
}

void read_values(const NetcdfVariable& v, int f, const std::string& where, CoefficientSet& set) {
  const auto n = std::size_t(set.lmax) + 1;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const double value = present_value(v, i * n + j);
      if (!std::isfinite(value))
        throw Error(Fault::file_syntax,
                    fmt::format("{}, row {}, column {}: {} is not a finite number", where, i, j, value));
      if (j <= i)
        set.first[set.index(f, int(i), int(j))] = value;
      else
        set.second[set.index(f, int(j), int(i) + 1)] = value;
    }
}

// What SHGravCoeffs.to_netcdf says of a potential.
void read_gravity(const NetcdfVariable& v, const std::string& where, CoefficientSet& set) {
  const NetcdfAttribute *gm = attribute(v.attributes, "GM"), *r0 = attribute(v.attributes, "r0");
  if (!gm || !r0 || gm->is_text || r0->is_text) return;
  if (!std::isfinite(gm->number) || !(r0->number > 0) || !std::isfinite(r0->number))
    throw Error(Fault::file_syntax, fmt::format("{}: GM is {} and r0 {}; both must be finite numbers, and r0 above 0",
                                                where, gm->number, r0->number));
  set.kind = CoefficientKind::potential;
  set.gm = gm->number;
  set.reference_radius = r0->number;
}

} // namespace

CoefficientSet parse_netcdf_coefficients(std::string bytes, const std::string& name, std::optional<double> metres) {
  const NetcdfFile netcdf = parse_netcdf(std::move(bytes), name);
  if (netcdf.variable("lat") && netcdf.variable("lon"))
    throw Error(Fault::file_format,
                fmt::format("{}: this is a grid, not coefficients; `cowgpu transform analyse` makes "
                            "coefficients of it",
                            netcdf.name));
  std::vector<std::string> notes;
  const std::vector<const NetcdfVariable*> fields = coefficient_variables(netcdf, notes);
  const std::uint64_t n = netcdf.dimensions[fields[0]->dimensions[0]].length;
  if (n < 1 || n > largest_file_degree + 1 || n != netcdf.dimensions[fields[0]->dimensions[1]].length)
    throw Error(Fault::file_format,
                fmt::format("{}: the file has {} degrees and {} orders: both must be lmax + 1, at most {}", netcdf.name,
                            n, netcdf.dimensions[fields[0]->dimensions[1]].length, largest_file_degree + 1));
  check_count(netcdf, "degree");
  check_count(netcdf, "order");
  CoefficientSet set(int(n) - 1, int(fields.size()));
  set.notes = std::move(notes);
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const NetcdfVariable& v = *fields[f];
    const std::string where = fmt::format("{}: variable {}", netcdf.name, shown(v.name));
    const Convention convention = convention_of(v, where);
    if (f > 0 && convention != set.convention)
      throw Error(Fault::file_format, where + " has another convention than the variables before it");
    set.convention = convention;
    read_values(v, int(f), where, set);
    if (const NetcdfAttribute* title = attribute(v.attributes, "title")) set.names[f] = one_line(title->text);
  }
  if (fields.size() == 1) read_gravity(*fields[0], netcdf.name, set);
  Metadata metadata;
  for (const NetcdfAttribute& a : netcdf.attributes)
    if (a.is_text) metadata[a.name] = {a.text, 0};
  for (const char* key : {"lmax", "normalisation", "phase", "form", "fields"}) metadata.erase(key);
  const bool ours = metadata.contains("cowgpu"); // others use such names for other things
  if (ours) take_metadata(metadata, netcdf.name, set);
  if (set.kind == CoefficientKind::potential && !ours) {
    set.units_stated = false;
    settle_length_unit(set, metres, true); // pyshtools keeps SI units
  }
  return set;
}

void write_netcdf_coefficients(const CoefficientSet& set, AtomicFile& file) {
  NetcdfWriter out;
  const auto n = std::size_t(set.lmax) + 1;
  const int dimensions[] = {out.dimension("degree", n), out.dimension("order", n)};
  const int degree = out.variable("degree", NetcdfWriter::Type::integer, std::span(dimensions, 1));
  const int order = out.variable("order", NetcdfWriter::Type::integer, std::span(dimensions + 1, 1));
  std::vector<int> fields;
  for (const std::string& word : field_names({}, set.fields, "coeffs")) {
    const int id = out.variable(word, NetcdfWriter::Type::real, dimensions);
    out.attribute(id, "title", set.names[fields.size()]);
    out.attribute(id, "description", fmt::format("cowgpu {}", version));
    out.attribute(id, "normalization", pyshtools_name(set.convention.normalisation));
    out.attribute(id, "csphase", std::int64_t(set.convention.phase == Phase::condon_shortley ? -1 : 1));
    fields.push_back(id);
    if (set.fields > 1) out.attribute(id, "field", std::int64_t(fields.size()));
    if (set.kind == CoefficientKind::potential && set.gm && set.reference_radius) {
      out.attribute(id, "GM", *set.gm);
      out.attribute(id, "r0", *set.reference_radius);
    }
  }
  out.attribute(NetcdfWriter::global, "cowgpu", version);
  for (const auto& [key, text] : metadata_of(set))
    if (key != "fields") out.attribute(NetcdfWriter::global, key, text);
  std::vector<double> row(n);
  for (std::size_t i = 0; i < n; ++i) row[i] = double(i);
  out.values(degree, row);
  out.values(order, row);
  for (int f = 0; f < set.fields; ++f)
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j)
        row[j] = j <= i ? set.first[set.index(f, int(i), int(j))] : set.second[set.index(f, int(j), int(i) + 1)];
      out.row(fields[std::size_t(f)], i, row);
    }
  out.write_to(file);
}

} // namespace cowgpu
