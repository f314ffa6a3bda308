#include "host/requests/map.hpp"

#include "host/backend.hpp"
#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/mesh/half_edges.hpp"
#include "host/mesh/winding_notes.hpp"
#include "host/requests/expand_flow.hpp"
#include "host/requests/limits.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cowgpu {
namespace {

SphereMap flow_map(const FlowMapOptions& options, unsigned threads, const ManifoldSurface& surface, Monitor& monitor,
                   FlowMapReport& report) {
  if (options.time) check_flow_time(*options.time, bounding_box(surface.vertices(), surface.faces()));
  const auto backend = make_cpu_backend(threads);
  report.origin = make_body(surface.closed(), options.origin, 1).origin;
  report.star = find_star_shape_time(surface.closed().mesh(), report.origin, *backend, monitor);
  report.time_choice = options.time ? "given" : "auto";
  report.time = flow_time(options.time.value_or(0), report.star);
  const FlowPoints ends = flow_vertices(surface, report.time, *backend, monitor, report.points);
  return direction_map(ends.positions, report.origin);
}

// Makes the map that is asked for.
struct Maker {
  MapResult& result;
  unsigned threads;
  Monitor& monitor;

  SphereMap operator()(const StretchOptions& options) const { return stretch_map(result.surface, options, monitor); }
  SphereMap operator()(const HarmonicOptions& options) const { return harmonic_map(result.surface, options, monitor); }
  SphereMap operator()(const SmoothOptions& options) const { return smooth_map(result.surface, options, monitor); }
  SphereMap operator()(const FlowMapOptions& options) const {
    return flow_map(options, threads, result.surface, monitor, result.flow.emplace());
  }
};

void check(const MapRequest& request) {
  require_range("the degree of the grid that a map is judged against is", request.lmax, 1, largest_grid_degree);
  require_range("the copies of the body are", request.relabellings, 0U, most_relabellings);
  if (const auto* stretch = std::get_if<StretchOptions>(&request.method))
    require_range("the sweeps are", stretch->sweeps, 0U, most_sweeps);
  if (const auto* harmonic = std::get_if<HarmonicOptions>(&request.method)) {
    require_member("the weights of edges are", harmonic->weights, EdgeWeights::tutte);
    require_member("the rule for the pole is", harmonic->pole.rule, Pole::Rule::back);
  }
}

} // namespace

MapResult make_map(MapRequest request, Monitor& monitor) {
  check(request);
  MapResult result{ManifoldSurface::from(ClosedSurface::from(std::move(request.mesh)))};
  const ManifoldSurface& surface = result.surface;
  require_sphere(surface);
  result.notes = body_notes(surface.closed(), monitor, request.threads);
  auto start = Clock::now();
  result.map = std::visit(Maker{result, request.threads, monitor}, request.method);
  result.map_seconds = seconds_since(start);
  check_stop(monitor);
  start = Clock::now();
  result.quality = judge(surface, result.map, request.lmax);
  result.judge_seconds = seconds_since(start);
  if (const auto* stretch = std::get_if<StretchOptions>(&request.method)) {
    result.stretch = measure_stretch(surface, result.map, stretch->lambda);
    start = Clock::now();
    result.repeats = repeat_stretch_map(surface, result.map, *stretch, request.relabellings, request.threads, monitor);
    result.repeat_seconds = seconds_since(start);
  }
  return result;
}

void check_map(const MapResult& result) {
  const double degree = std::abs(result.quality.degree);
  if (std::abs(degree - 1) <= 1e-6) return;
  if (result.flow)
    throw Error(
        Fault::map_failed,
        fmt::format("the flow brings the vertices so far apart that the triangles between them cover the sphere "
                    "{:.3g} times instead of once: cut the mesh finer, or take a shorter time",
                    degree));
  throw Error(Fault::map_failed,
              fmt::format("the map covers the sphere {:.3g} times: rounding has spoilt it; leave the scale of the disk "
                          "out, or take the map of least stretch",
                          degree));
}

} // namespace cowgpu
