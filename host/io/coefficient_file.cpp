#include "host/io/coefficient_file.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/io/coefficient_formats.hpp"
#include "host/io/foreign_file.hpp"
#include "host/io/gfc.hpp"
#include "host/io/length_unit.hpp"
#include "host/io/number.hpp"
#include "host/io/shtools_text.hpp"
#include "host/spectrum/convert.hpp"

#include <fmt/format.h>

namespace cowgpu {

CoefficientFormat coefficient_format(const std::filesystem::path& path) {
  if (const auto format = coefficient_format_named(path)) return *format;
  throw Error(
      Fault::bad_argument,
      fmt::format("{}: the name must end in .nc (netCDF), .csv, .json, .gfc (ICGEM) or .sh (SHTOOLS)", path.string()));
}

CoefficientSet read_coefficient_set(const std::filesystem::path& path, const std::string& of,
                                    std::optional<double> metres) {
  std::string bytes = read_input_file(path);
  const std::string name = path.string();
  const auto held = coefficient_format_in(bytes), named = coefficient_format_named(path);
  if (!held && named == CoefficientFormat::shtools && holds_mesh(bytes))
    throw Error(Fault::file_format, name + ": this is a mesh and no table of coefficients");
  if (!held && !named)
    throw Error(bytes.empty() ? Fault::file_truncated : Fault::file_format,
                bytes.empty()
                    ? name + ": the file is empty"
                    : fmt::format("{}: this is not a file of coefficients: JSON and CSV of this program, netCDF, "
                                  "ICGEM's .gfc, and tables with rows degree, order, C, S are read",
                                  name));
  const CoefficientFormat format =
      held ? *held : *named; // where the content says nothing, the reader says what is wrong
  if (!of.empty() && format != CoefficientFormat::json && format != CoefficientFormat::csv)
    throw Error(Fault::bad_argument,
                fmt::format("--of {}: {} holds no expansions to choose from; the .json and .csv of `cowgpu expand` do",
                            of, name));
  switch (format) {
  case CoefficientFormat::json: return parse_json_coefficients(bytes, name, of);
  case CoefficientFormat::csv: return parse_csv_coefficients(bytes, name, of);
  case CoefficientFormat::netcdf: return parse_netcdf_coefficients(std::move(bytes), name, metres);
  case CoefficientFormat::gfc: return parse_gfc(bytes, name, metres);
  case CoefficientFormat::shtools: return parse_shtools_text(bytes, name, metres);
  }
  return {};
}

CoefficientSet read_in_unit(const std::filesystem::path& path, const std::string& of, std::optional<double> metres) {
  CoefficientSet set = read_coefficient_set(path, of, metres);
  if (metres && set.units_stated) state_length_unit(set, *metres, path.string());
  return set;
}

std::string not_held(const CoefficientSet& set, CoefficientFormat format) {
  const bool gfc = format == CoefficientFormat::gfc, shtools = format == CoefficientFormat::shtools;
  if (gfc && set.kind == CoefficientKind::field)
    return "a .gfc file holds the gravity field of a body, and these are coefficients of other fields; .nc, .csv, "
           ".json "
           "and .sh hold them";
  if ((gfc || shtools) && set.kind == CoefficientKind::multipoles)
    return "mass multipoles go into .json, .csv and .nc; .gfc and .sh hold the coefficients of the potential";
  if ((gfc || shtools) && set.kind == CoefficientKind::potential && !(set.gm && set.reference_radius))
    return "coefficients of a potential without GM or reference radius, which .gfc and .sh ask for; .json, .csv and "
           ".nc "
           "hold them";
  if ((gfc || shtools) && set.fields > 1)
    return fmt::format("{} fields, and a .sh file holds one; choose with --field, or take .nc, .csv or .json",
                       set.fields);
  if (set.form == Form::complex && format != CoefficientFormat::json && format != CoefficientFormat::csv)
    return "the complex form goes into .csv and .json; .nc, .gfc and .sh are real";
  if (gfc && set.convention.phase != Phase::none)
    return "a .gfc file has no Condon-Shortley phase; .nc, .csv, .json and .sh can have it";
  if (gfc && set.convention.normalisation != Normalisation::four_pi &&
      set.convention.normalisation != Normalisation::unnormalised)
    return fmt::format(
        "a .gfc file is 4pi (fully normalised) or unnormalised, and not {}; .nc, .csv, .json and .sh can "
        "be",
        name(set.convention.normalisation));
  return "";
}

void write_coefficient_set(const CoefficientSet& set, CoefficientFormat format, AtomicFile& file) {
  if (const std::string reason = not_held(set, format); !reason.empty()) throw Error(Fault::bad_argument, reason);
  switch (format) {
  case CoefficientFormat::json: return write_json_coefficients(set, file);
  case CoefficientFormat::csv: return write_csv_coefficients(set, file);
  case CoefficientFormat::netcdf: return write_netcdf_coefficients(set, file);
  case CoefficientFormat::gfc: return write_gfc(set, file);
  case CoefficientFormat::shtools: return write_shtools_text(set, file);
  }
}

CoefficientSet read_fields(const std::filesystem::path& path, std::optional<double> metres) {
  CoefficientSet set = read_in_unit(path, "", metres);
  if (set.kind == CoefficientKind::multipoles && set.names == std::vector<std::string>{""})
    set.names = {mass_expansion};
  if (set.kind == CoefficientKind::multipoles && set.reference_radius) {
    std::string r;
    append_number(r, *set.reference_radius);
    set.notes.push_back(expansion_note(r));
  }
  if (set.kind == CoefficientKind::potential)
    set.notes.push_back("these are coefficients of a gravitational potential V: the field is V R / GM at r = R");
  return set;
}

SphereCoefficients field_coefficients(const CoefficientSet& set, const std::string& name) {
  try {
    return orthonormal(set);
  } catch (const Error& error) { // a bad file, not a bad command line
    throw Error(Fault::file_format, fmt::format("{}: {}", name, error.what()));
  }
}

} // namespace cowgpu
