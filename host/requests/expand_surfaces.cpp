#include "host/requests/expand_surfaces.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/foreign_file.hpp"
#include "host/io/map_file.hpp"
#include "host/io/mesh_source.hpp"
#include "host/io/sha256.hpp"
#include "host/map/harmonic.hpp"
#include "host/map/smooth.hpp"
#include "host/map/stretch.hpp"
#include "host/mesh/half_edges.hpp"
#include "host/requests/expand_flow.hpp"
#include "host/requests/limits.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

SphereMap make_map(MapMethod method, const HarmonicOptions& harmonic, const ManifoldSurface& surface,
                   Monitor& monitor) {
  if (method == MapMethod::stretch) return stretch_map(surface, {}, monitor);
  if (method == MapMethod::smooth) return smooth_map(surface, {}, monitor);
  return harmonic_map(surface, harmonic, monitor);
}

SurfaceResult expand_over(MapMethod method, const ExpansionChoice& choice, bool estimate_aliasing, const Body& body,
                          const ManifoldSurface& surface, Backend& backend, Monitor& monitor) {
  const bool as_chosen = method == MapMethod::harmonic || method == MapMethod::flow;
  const MapReading reading = as_chosen ? choice.reading : MapReading{};
  SurfaceResult result;
  result.recipe = reading.recipe;
  result.origin_kind = reading.mesh_origin ? "mesh" : body.origin_kind;
  result.of = method;
  result.beside_paper = reading.beside_paper && choice.lmax >= 3 && body.surface.mesh().sha256 == benchmark_sha256 &&
                        body.placement.is_identity();
  if (body.units().stated) result.length_unit = "metres";
  const Vec3 origin = reading.mesh_origin ? Vec3::Zero() : body.origin;
  const int judged_degree = surface_grid_degree(choice.lmax) / 2;
  if (method == MapMethod::flow) {
    expand_flow(choice, estimate_aliasing, surface, origin, backend, monitor, result);
    result.quality = judge(surface, result.map, judged_degree);
    return result;
  }
  result.closest_point = reading.closest_point;
  const auto start = Clock::now();
  if (choice.map_file.empty())
    result.map = make_map(method, choice.harmonic, surface, monitor);
  else {
    const std::string bytes = read_input_file(choice.map_file);
    result.map = read_map(bytes, choice.map_file, surface, method);
    if (!body.placement.rotation.isIdentity(0)) {
      for (Vec3& p : result.map.positions) p = body.placement.rotation * p;
      result.map.notes.push_back("the map of the file was turned with the body");
    }
    result.map_file = choice.map_file;
    result.map_sha256 = sha256_hex(std::string_view(bytes));
  }
  result.map_seconds = seconds_since(start);
  result.quality = judge(surface, result.map, judged_degree);
  ExpandSurfaceOptions options;
  options.lmax = choice.lmax;
  options.origin = origin;
  options.closest_point = reading.closest_point;
  options.signed_dphi = reading.signed_dphi;
  options.estimate_aliasing = estimate_aliasing || reading.estimate_aliasing;
  result.expansion =
      expand_surface(surface.vertices(), surface.faces(), result.map, options, backend, monitor, &result.report);
  return result;
}

} // namespace

void check_expansions(const ExpansionChoice& choice) {
  const auto asked_for = [&](MapMethod map) {
    return std::find(choice.maps.begin(), choice.maps.end(), map) != choice.maps.end();
  };
  std::vector<std::string_view> words;
  if (choice.mass) words.emplace_back("mass");
  for (const MapMethod map : choice.maps) words.push_back(name(map));
  const bool flow = asked_for(MapMethod::flow);
  for (std::size_t i = 0; i < choice.maps.size(); ++i)
    if (std::find(made_maps.begin(), made_maps.end(), choice.maps[i]) == made_maps.end() ||
        std::find(choice.maps.begin() + std::ptrdiff_t(i) + 1, choice.maps.end(), choice.maps[i]) != choice.maps.end())
      throw Error(Fault::bad_argument, "maps are some of harmonic, stretch, smooth and flow, each once");
  if (flow) {
    require_member("the meaning of the flow is", choice.flow.meaning, FlowMeaning::steps);
    require_range("the degree of the flow's grid is", choice.flow.grid_degree, least_flow_grid, largest_grid_degree);
    require_range("the refinements of the mesh are", choice.flow.refinements, 1, most_refinements);
  }
  if (!choice.map_file.empty() && (choice.maps.size() != 1 || flow))
    throw Error(Fault::bad_argument,
                fmt::format("--map {}: the file is one map, and --of {} asks for {}; name the one that it stands for "
                            "with --of harmonic, stretch or smooth",
                            choice.map_file, fmt::join(words, ","),
                            choice.maps.empty()      ? "none"
                            : choice.maps.size() > 1 ? "several"
                                                     : "the flow, whose map is not kept in a file"));
}

MemoryNeed surfaces_memory(const ExpansionChoice& choice, std::span<const Vec3> vertices, std::span<const Face> faces,
                           const Backend& backend) {
  if (choice.maps.empty()) return {};
  MemoryNeed need = expand_surface_memory(faces.size(), choice.lmax, backend);
  need.host += (choice.maps.size() - 1) * 6 * 16 * SphereCoefficients::count(choice.lmax);
  if (choice.maps.back() == MapMethod::flow) {
    const MemoryNeed flow = expand_flow_memory(choice.flow, choice.lmax, vertices, faces, backend);
    need.host += flow.host;
    need.device = std::max(need.device, flow.device);
  }
  return need;
}

std::vector<SurfaceResult> expand_surfaces(const ExpansionChoice& choice, bool estimate_aliasing, const Body& body,
                                           Backend& backend, Monitor& monitor) {
  std::vector<SurfaceResult> results;
  if (choice.maps.empty()) return results;
  const auto surface = ManifoldSurface::from(body.surface);
  require_sphere(surface);
  for (const MapMethod method : choice.maps)
    results.push_back(expand_over(method, choice, estimate_aliasing, body, surface, backend, monitor));
  return results;
}

void check_surfaces(std::span<const SurfaceResult> results) {
  for (const SurfaceResult& result : results)
    if (result.flow && !result.flow->failure.empty())
      throw Error(Fault::check_failed, fmt::format("--of {}: {}", name(result.of), result.flow->failure));
}

} // namespace cowgpu
