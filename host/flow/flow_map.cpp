#include "host/flow/flow_map.hpp"

#include "host/error.hpp"
#include "host/flow/fixed_steps.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/subdivide.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/spectrum/surface_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu {
namespace {

constexpr double paper_step = 0.05;
constexpr double auto_tolerance = 1e-6; // of the star-shape time, in diagonals

// The mean of an angle is kept as a number, not as a coefficient.
void put_means(SurfaceExpansion& expansion) {
  const auto take = [&](int field) {
    const double mean = expansion.coefficients.at(field, 0, 0).real() / std::sqrt(4 * std::numbers::pi);
    expansion.coefficients.at(field, 0, 0) = 0;
    return mean;
  };
  expansion.mean_dtheta = take(1);
  expansion.mean_dphi = take(2);
}

} // namespace

SphereMap direction_map(std::span<const Vec3> positions, const Vec3& origin) {
  SphereMap map;
  map.method = "flow";
  map.positions.reserve(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3 from = positions[v] - origin;
    if (!(from.norm() > 0))
      throw Error(Fault::map_failed, fmt::format("vertex {} flows to the origin itself, which has no direction: take "
                                                 "another origin or time",
                                                 v));
    map.positions.push_back(from.normalized());
  }
  return map;
}

SphereMap paper_flow_map(const RawMesh& mesh, const Vec3& origin, Backend& backend, Monitor& monitor, double time) {
  const auto field = backend.distance_field(mesh.vertices, mesh.faces);
  const int steps = std::max(1, int(std::lround(time / paper_step)));
  const auto ends =
      flow_fixed_steps(*field, mesh.vertices, vertex_normals(mesh.vertices, mesh.faces), time, steps, monitor);
  SphereMap map = direction_map(ends, origin);
  map.notes.push_back(fmt::format(
      "The mesh's vertices flowed along the distance's gradient for {} in {} Runge-Kutta steps.", time, steps));
  return map;
}

LevelSetExpansion expand_level_set(const RawMesh& mesh, double time, const ExpandSurfaceOptions& options,
                                   Backend& backend, Monitor& monitor) {
  if (!(time >= 0) || !std::isfinite(time))
    throw Error(Fault::bad_argument, fmt::format("a level set lies at a distance above 0, not {}", time));
  const Box box = bounding_box(mesh.vertices, mesh.faces);
  const double diagonal = (box.max - box.min).norm();
  LevelSetExpansion result;
  result.star = star_shape_time(mesh.vertices, mesh.faces, options.origin, auto_tolerance * diagonal, backend, monitor);
  result.time = time > 0 ? time : result.star.upper;
  if (!std::isfinite(result.time))
    throw Error(Fault::map_failed,
                "no time was found from which the inflated body is star-shaped about this origin: give "
                "one, or take another origin");
  const auto field = backend.distance_field(mesh.vertices, mesh.faces);
  bool first = true; // the grid of the result comes before the one of the aliasing's estimate
  const auto sampler = [&](const SphereGrid& grid, ExpandSurfaceReport&) {
    LevelSetReport met;
    const auto positions =
        level_set_positions(*field, box.min, box.max, options.origin, result.time, grid, monitor, &met);
    if (first) result.level_set = met;
    first = false;
    return surface_fields(positions, grid, options.origin, options.signed_dphi);
  };
  result.expansion = expand_surface(sampler, options, backend, monitor, &result.report);
  return result;
}

SheetExpansion expand_sheets(const RawMesh& mesh, double time, int refinements, double tolerance,
                             const ExpandSurfaceOptions& options, DistanceFlow& flow, Backend& backend,
                             Monitor& monitor) {
  if (refinements < 1 || refinements > 5)
    throw Error(Fault::bad_argument,
                fmt::format("sheets are extrapolated from 1 to 5 refinements, not {}", refinements));
  if (!(time > 0)) throw Error(Fault::bad_argument, fmt::format("sheets of a flow take a time above 0, not {}", time));
  // Each level's vertices are the first of the next.
  std::vector<RawMesh> meshes = {mesh};
  for (int k = 0; k < refinements; ++k) meshes.push_back(split_midpoint(meshes.back()));
  SheetExpansion result;
  FlowOptions flow_options;
  flow_options.time = time;
  flow_options.tolerance = tolerance;
  const RawMesh& finest = meshes.back();
  const FlowPoints ends =
      flow.flow(finest.vertices, vertex_normals(finest.vertices, finest.faces), flow_options, monitor, &result.flow);
  for (const RawMesh& level : meshes) {
    const SphereMap map = direction_map(std::span(ends.positions).first(level.vertices.size()), options.origin);
    SheetReport sheets;
    const auto sampler = [&](const SphereGrid& grid, ExpandSurfaceReport&) {
      return sheet_fields(level.vertices, level.faces, map.positions, grid, options.origin, options.signed_dphi,
                          monitor, &sheets);
    };
    ExpandSurfaceOptions of_level = options;
    of_level.estimate_aliasing = false;
    result.expansion = expand_surface(sampler, of_level, backend, monitor, &result.report);
    result.sheets.push_back(sheets);
    result.levels.push_back(result.expansion.coefficients);
    const double whole = std::sqrt(4 * std::numbers::pi);
    result.levels.back().at(1, 0, 0) = whole * result.expansion.mean_dtheta;
    result.levels.back().at(2, 0, 0) = whole * result.expansion.mean_dphi;
  }
  const std::size_t n = result.levels.size();
  const SphereCoefficients &last = result.levels[n - 1], &before = result.levels[n - 2];
  result.expansion.coefficients = last;
  result.uncertainty.resize(std::size_t(options.lmax) + 1);
  for (int l = 0; l <= options.lmax; ++l)
    for (int f = 0; f < 6; ++f)
      for (int m = 0; m <= l; ++m) {
        const auto change = last.at(f, l, m) - before.at(f, l, m);
        result.expansion.coefficients.at(f, l, m) = last.at(f, l, m) + change;
        double off = std::abs(change) / 2;
        if (n > 2)
          off = std::max(off, std::abs(2. * change - (before.at(f, l, m) - result.levels[n - 3].at(f, l, m))));
        else
          off = std::abs(change);
        double& most = result.uncertainty[std::size_t(l)][std::size_t(f)];
        most = std::max(most, off);
      }
  put_means(result.expansion);
  return result;
}

} // namespace cowgpu
