#include "host/requests/inflate.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/mesh/topology.hpp"
#include "host/mesh/winding_notes.hpp"
#include "host/requests/expand_flow.hpp"
#include "host/requests/limits.hpp"
#include "host/requests/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

// What is to be said of a body whose volume or area the cubes leave open by more than a hundredth.
std::string coarse_note(const InflatedBody& body, int cells) {
  const double part = std::max(body.error.volume_error / std::abs(body.audit.volume.value_or(std::nan(""))),
                               body.error.area_error / body.audit.area);
  if (part <= 0.01) return {};
  const double wanted = std::ceil(cells * body.report.cell / body.level);
  const std::string cure = cells >= most_cells ? "take a longer level"
                           : wanted > cells ? fmt::format("take --cells {:.0f}", std::min(wanted, double(most_cells)))
                                            : fmt::format("take --cells {}", std::min(2 * cells, most_cells));
  return fmt::format(
      "the level {:.6g} is found in cubes of {:.3g}, and its volume and area are known only to {:.2g} %; {}",
      body.level, body.report.cell, 100 * part, cure);
}

// The distance that a level means.
double level_of(const std::optional<double>& given, const InflateResult& result) {
  const Body& body = result.body;
  const double longest = body.box.longest_side();
  if (!given && result.star->lower == 0 && result.star->upper < 1e-4 * longest)
    throw Error(
        Fault::bad_argument,
        fmt::format(
            "--levels star: {} is star-shaped about ({:.6g}, {:.6g}, {:.6g}) as it is, or nearly, t* <= {:.3g}: "
            "there is nothing to show; name levels by numbers, or another --origin",
            called(body.surface.mesh()), body.origin.x(), body.origin.y(), body.origin.z(), result.star->upper));
  const double level = given ? *given : flow_time(0, *result.star);
  if (!(level >= 1e-4 * longest && level <= 1e4 * longest))
    throw Error(Fault::bad_argument,
                fmt::format("a level of {:.6g} cannot be shown beside a body {:.6g} long: levels go from 1e-4 of that "
                            "to 1e4 times that",
                            level, longest));
  return level;
}

InflatedBody inflated(double level, int cells, const Body& body, DistanceField& field, Monitor& monitor) {
  InflatedBody result;
  result.level = level;
  result.surface = level_surface(field, body.box.min, body.box.max, level, cells, monitor, &result.report);
  result.error =
      level_surface_error(field, body.box.min, body.box.max, level, cells, result.surface, result.report, monitor);
  result.surface.name = fmt::format("{} inflated by {:.6g}", called(body.surface.mesh()), level);
  RawMesh found;
  found.vertices = result.surface.vertices;
  found.faces = result.surface.faces;
  result.audit = audit(found);
  if (!result.audit.closed || !result.audit.consistently_oriented)
    throw Error(Fault::check_failed, fmt::format("the level set {:.6g} came out with {} open edges: this is a fault of "
                                                 "the program",
                                                 level, result.audit.open_edges));
  result.note = coarse_note(result, cells);
  check_stop(monitor);
  return result;
}

} // namespace

MemoryNeed inflate_memory(const InflateRequest& request, const Backend& backend) {
  if (request.levels.empty()) return {};
  // At most a quarter of the cubes is near the level, in thin bodies and for coarse lattices.
  const auto cells = std::uint64_t(request.cells);
  MemoryNeed need = backend.distance_field(request.mesh.vertices, request.mesh.faces)
                        ->memory(cells * cells * cells / 64 + 16 * cells * cells);
  need.host += 600 * 6 * cells * cells;
  return need;
}

InflateResult inflate(InflateRequest request, Backend& backend, Monitor& monitor,
                      const std::function<void(InflatedBody&)>& done) {
  require_range("the cubes along the longest side are", request.cells, least_cells, most_cells);
  check_memory(inflate_memory(request, backend), backend, "lower --cells");
  InflateResult result{make_body(ClosedSurface::from(std::move(request.mesh)), request.origin, 1), backend.facts()};
  const Body& body = result.body;
  result.notes = body_notes(body.surface, monitor, request.threads);
  const std::vector<std::optional<double>>& levels = request.levels;
  if (request.star || levels.empty() || std::find(levels.begin(), levels.end(), std::nullopt) != levels.end()) {
    const auto start = Clock::now();
    result.star = find_star_shape_time(body.surface.mesh(), body.origin, backend, monitor);
    result.star_seconds = seconds_since(start);
  }
  std::vector<double> distances;
  for (const auto& level : levels) distances.push_back(level_of(level, result));
  const auto field = backend.distance_field(body.surface.vertices(), body.surface.faces());
  for (const double level : distances) {
    result.bodies.push_back(inflated(level, request.cells, body, *field, monitor));
    if (done) done(result.bodies.back());
  }
  return result;
}

} // namespace cowgpu
