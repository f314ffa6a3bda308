#include "host/io/surface_file.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/coefficient_metadata.hpp"
#include "host/io/result_json.hpp"
#include "host/io/shown.hpp"
#include "host/map/map_method.hpp"
#include "host/spectrum/convert.hpp"
#include "host/spectrum/expand_surface.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <vector>

namespace cowgpu {
namespace {

// So that the fifth powers of lengths stay in range.
constexpr double largest_coefficient = 1e50;

using nlohmann::json;
using result_json::member;

std::string chosen(const std::string& name, const std::vector<std::string>& there, const std::string& of) {
  const auto has = [&](const std::string& key) { return std::find(there.begin(), there.end(), key) != there.end(); };
  std::string list;
  for (const std::string& key : there) list += (list.empty() ? "" : ", ") + shown(key);
  if (!of.empty()) {
    if (has(of)) return of;
    throw Error(Fault::bad_argument,
                fmt::format("--of {}: {} has no such expansion of a surface; there is {}", of, name, list));
  }
  if (const std::string stretch(cowgpu::name(MapMethod::stretch)); has(stretch)) return stretch;
  if (there.size() == 1) return there.front();
  throw Error(Fault::bad_argument,
              fmt::format("{} has several expansions of a surface: {}; choose one with --of", name, list));
}

std::string chosen(const std::string& name, const json& expansions, const std::string& of) {
  std::vector<std::string> there;
  if (!expansions.is_object())
    throw Error(Fault::file_format, fmt::format("{}: the member 'expansions' must be an object", name));
  for (const auto& [key, value] : expansions.items())
    if (key != mass_expansion) there.push_back(key);
  if (there.empty())
    throw Error(Fault::file_format,
                fmt::format("{}: this file holds no expansion of a surface; make one with `cowgpu expand MESH --of "
                            "stretch -o FILE.json`",
                            name));
  return chosen(name, there, of);
}

std::string text(const std::string& name, const json& object, const char* key) {
  const json& value = member(name, object, key);
  if (!value.is_string()) throw Error(Fault::file_format, fmt::format("{}: the member '{}' must be a text", name, key));
  return one_line(value.get<std::string>());
}

Vec3 point(const std::string& name, const json& object, const char* key) {
  const json& value = member(name, object, key);
  if (!value.is_array() || value.size() != 3 ||
      !std::all_of(value.begin(), value.end(), [](const json& c) { return c.is_number(); }))
    throw Error(Fault::file_format, fmt::format("{}: the member '{}' is not three numbers", name, key));
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

[[noreturn]] void not_a_surface(const std::string& file, const std::string& what) {
  throw Error(Fault::file_format,
              fmt::format("{} holds {}, and a body is rebuilt from coefficients of a surface: fields f_r, f_dtheta, "
                          "f_dphi, x, y, z, as `cowgpu expand --of stretch -o FILE` writes them; or take the mesh",
                          file, what));
}

// The columns of `cowgpu expand -o FILE.csv` are named after their expansion.
CoefficientSet read_fields_of_surface(const std::filesystem::path& path, const std::string& of) {
  CoefficientSet set = read_coefficient_set(path, of);
  if (!of.empty() || set.kind != CoefficientKind::field) return set;
  std::vector<std::string> there;
  for (const std::string& field : set.names)
    if (field.ends_with("_f_r")) there.push_back(field.substr(0, field.size() - 4));
  if (there.empty()) return set;
  return read_coefficient_set(path, chosen(path.string(), there, of));
}

} // namespace

bool is_result_file(const std::filesystem::path& path) {
  return path.extension() == ".json";
}

SurfaceFile read_surface(const std::filesystem::path& path, const std::string& of) {
  const std::string name = path.string();
  const json all = result_json::read(path);
  const json& expansions = member(name, all, "expansions");
  SurfaceFile file;
  file.name = chosen(name, expansions, of);
  const json& surface = expansions.at(file.name);
  if (member(name, surface, "fields") != json(surface_field_names))
    throw Error(Fault::file_format,
                fmt::format("{}: the fields of {} are not f_r, f_dtheta, f_dphi, x, y, z", name, shown(file.name)));
  const std::string dphi = text(name, surface, "dphi");
  if (dphi != "signed" && dphi != "absolute")
    throw Error(Fault::file_format, fmt::format("{}: dphi is '{}'; it must be signed or absolute", name, shown(dphi)));
  const json& means = member(name, surface, "removed_means");
  SurfaceExpansion& expansion = file.expansion;
  expansion.signed_dphi = dphi == "signed";
  expansion.origin = point(name, surface, "origin");
  expansion.mean_dtheta = result_json::number(name, means, "f_dtheta");
  expansion.mean_dphi = result_json::number(name, means, "f_dphi");
  file.recipe = text(name, surface, "recipe");
  file.map_method = text(name, member(name, surface, "map"), "method");
  const json& mesh = member(name, all, "mesh");
  file.mesh = text(name, mesh, "name");
  file.mesh_hash = text(name, mesh, "sha256");
  file.placement = result_json::placement(name, all);
  expansion.coefficients =
      result_json::coefficients(name, surface, int(surface_field_names.size()), largest_surface_degree);
  const double mean = spherical_radius(expansion);
  if (!(mean > 0))
    throw Error(
        Fault::file_format,
        fmt::format("{}: the coefficient (0, 0) of f_r gives a mean distance of {:g} from the origin, which must "
                    "be positive: the file was changed, or is of no surface",
                    name, mean));
  for (const std::complex<double>& a : expansion.coefficients.values)
    if (!(std::abs(a) <= largest_coefficient))
      throw Error(Fault::file_format,
                  fmt::format("{}: a coefficient of {} has the size {:g}; surfaces up to {:g} are rebuilt", name,
                              shown(file.name), std::abs(a), largest_coefficient));
  return file;
}

bool holds_expansions(const std::filesystem::path& path) {
  if (!is_result_file(path)) return false;
  const json document = result_json::parse(path);
  return document.is_object() && document.contains("expansions");
}

SurfaceFile read_surface_fields(const std::filesystem::path& path, const std::string& of) {
  const std::string name = path.string();
  const CoefficientSet set = read_fields_of_surface(path, of);
  if (set.kind != CoefficientKind::field)
    not_a_surface(name, fmt::format("coefficients of a mass ({})", cowgpu::name(set.kind)));
  if (set.names != std::vector<std::string>(surface_field_names.begin(), surface_field_names.end()))
    not_a_surface(name, fmt::format("coefficients of {} field{}{}", set.fields, set.fields == 1 ? "" : "s",
                                    set.names[0].empty() ? "" : fmt::format(" ({} ...)", set.names[0])));
  SurfaceFile file;
  file.name = of.empty() ? "surface" : of;
  file.expansion.coefficients = orthonormal(set);
  file.expansion.origin = set.origin.value_or(Vec3::Zero());
  file.expansion.mean_dtheta = remark_number(set, name, "removed_mean_f_dtheta", 0);
  file.expansion.mean_dphi = remark_number(set, name, "removed_mean_f_dphi", 0);
  file.mesh = set.provenance.mesh;
  file.placement.units.stated = set.in_metres();
  file.notes = set.notes;
  if (!(spherical_radius(file.expansion) > 0))
    throw Error(Fault::file_format,
                fmt::format("{}: the coefficient (0, 0) of f_r must be above 0: it gives the mean distance", name));
  return file;
}

} // namespace cowgpu
