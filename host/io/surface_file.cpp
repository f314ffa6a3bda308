#include "host/io/surface_file.hpp"

#include "host/coefficient_set.hpp"
#include "host/error.hpp"
#include "host/io/result_json.hpp"
#include "host/io/shown.hpp"
#include "host/map/map_method.hpp"
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

std::string chosen(const std::string& name, const json& expansions, const std::string& of) {
  std::vector<std::string> there;
  if (!expansions.is_object())
    throw Error(Fault::file_format, fmt::format("{}: the member 'expansions' must be an object", name));
  for (const auto& [key, value] : expansions.items())
    if (key != mass_expansion) there.push_back(key);
  const auto has = [&](const std::string& key) { return std::find(there.begin(), there.end(), key) != there.end(); };
  if (there.empty())
    throw Error(Fault::file_format,
                fmt::format("{}: this file holds no expansion of a surface; make one with `cowgpu expand MESH --of "
                            "stretch -o FILE.json`",
                            name));
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

} // namespace cowgpu
