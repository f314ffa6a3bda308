#include "host/flow/flow_map.hpp"

#include "host/error.hpp"
#include "host/flow/fixed_steps.hpp"
#include "host/mesh/convex_hull.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/subdivide.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/spectrum/power.hpp"
#include "host/spectrum/rotation.hpp"
#include "host/spectrum/surface_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu {
namespace {

constexpr double suture_threshold = 0.04; // diagonals
// Of the grids that are compared: edges along one are not along another.
constexpr std::array turns = {EulerAngles{0.6, 1.1, 2.3}, EulerAngles{2.7, 0.7, 1.9}, EulerAngles{1.7, 2.0, 0.4}};
constexpr int level_set_grid_degree = 1024, sheet_grid_degree = 1024, slope_from = 16;

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

// What rounding leaves of places; far from the coordinates' zero points on the surface are rounded to what doubles hold there.
void add_rounding(const Box& box, const LevelSetReport& met, const SphereCoefficients& a,
                  std::vector<std::array<double, 6>>& uncertainty) {
  const double largest = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff()),
               whole = std::sqrt(4 * std::numbers::pi);
  const double length = whole * (largest * 0x1p-53 + met.place_error);
  const double angle =
      whole * (whole * largest * 0x1p-53 / a.at(0, 0, 0).real() + met.angle_error); // at the mean distance
  for (auto& fields : uncertainty)
    for (std::size_t f = 0; f < 6; ++f) fields[f] += f == 1 || f == 2 ? angle : length;
}

// [degree][field]: the largest over m of the differences; and their norms.
std::pair<std::vector<std::array<double, 6>>, std::vector<std::array<double, 6>>>
differences(const SphereCoefficients& a, const SphereCoefficients& b) {
  std::vector<std::array<double, 6>> most(std::size_t(a.lmax) + 1), norms = most;
  for (int l = 0; l <= std::min(a.lmax, b.lmax); ++l)
    for (int f = 0; f < a.fields; ++f)
      for (int m = 0; m <= l; ++m) {
        const double off = std::abs(a.at(f, l, m) - b.at(f, l, m));
        double &largest = most[std::size_t(l)][std::size_t(f)], &norm = norms[std::size_t(l)][std::size_t(f)];
        largest = std::max(largest, off);
        norm = std::hypot(norm, off, m == 0 ? 0 : off);
      }
  return {most, norms};
}

// Somewhat more than the largest among the fields of one kind, lengths or angles, and the degrees beside: a single
// difference may be small by chance, since both grids may err alike.
std::vector<std::array<double, 6>> with_neighbours(const std::vector<std::array<double, 6>>& change) {
  std::vector<std::array<double, 6>> rows = change;
  const std::size_t last = change.size() - 1;
  for (std::size_t l = 0; l <= last; ++l)
    for (std::size_t f = 0; f < 6; ++f) {
      const bool angle = f == 1 || f == 2;
      double most = 0;
      for (std::size_t k = l < 2 ? 0 : l - 2; k <= std::min(l + 2, last); ++k)
        for (std::size_t g = 0; g < 6; ++g)
          if ((g == 1 || g == 2) == angle) most = std::max(most, change[k][g]);
      rows[l][f] = 1.4 * most;
    }
  return rows;
}

// What a share of the sphere does whose values are not known within the body at all: |Y_lm| <= sqrt((2 l + 1) / 4 pi).
std::vector<std::array<double, 6>> unknown_share(double angle, const Box& box, double farthest, int lmax) {
  const Vec3 sides = box.max - box.min;
  const std::array<double, 6> ranges = {farthest,  std::numbers::pi, 2 * std::numbers::pi,
                                        sides.x(), sides.y(),        sides.z()};
  std::vector<std::array<double, 6>> rows(std::size_t(lmax) + 1);
  for (int l = 0; l <= lmax; ++l)
    for (std::size_t f = 0; f < 6; ++f)
      rows[std::size_t(l)][f] = angle * ranges[f] * std::sqrt((2 * l + 1) / (4 * std::numbers::pi));
  return rows;
}

// Whether what the unsettled directions leave open is more than the grid leaves, and more than what is printed of lengths and
// angles, in any of the degrees whose uncertainty is printed.
std::string unsettled_sentence(const LevelSetExpansion& result, const std::vector<std::array<double, 6>>& of_grid,
                               std::uint64_t directions) {
  const double size = result.expansion.coefficients.at(0, 0, 0).real();
  for (std::size_t l = 0; l < of_grid.size() && l <= 8; ++l)
    for (std::size_t f = 0; f < 6; ++f) {
      const double open = result.unsettled[l][f], printed = 5e-5 * (f == 1 || f == 2 ? 1 : std::min(1.0, size));
      if (!(open > std::max(of_grid[l][f], printed))) continue;
      return fmt::format(
          "{} of {} directions did not settle on the level set, and what they leave open, {:.1e} in {} at "
          "degree {}, is more than the {:.1e} that the grid does: take a longer --time, or another "
          "--origin",
          result.level_set.unsettled, directions, open, surface_field_names[f], l, of_grid[l][f]);
    }
  return {};
}

SphereCoefficients with_means(const SurfaceExpansion& expansion) {
  SphereCoefficients all = expansion.coefficients;
  const double whole = std::sqrt(4 * std::numbers::pi);
  all.at(1, 0, 0) = whole * expansion.mean_dtheta;
  all.at(2, 0, 0) = whole * expansion.mean_dphi;
  return all;
}

} // namespace

double monopole_at_large_times(std::span<const Vec3> vertices, const Vec3& origin) {
  const std::vector<Face> hull = convex_hull(vertices);
  if (hull.empty())
    throw Error(Fault::bad_argument, "all vertices lie in one plane: their hull has no corners with normal cones");
  const std::vector<double> solid = normal_cone_solid_angles(vertices, hull);
  double sum = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) sum += (vertices[i] - origin).norm() * solid[i];
  return sum / std::sqrt(4 * std::numbers::pi);
}

SphereMap direction_map(std::span<const Vec3> positions, const Vec3& origin) {
  SphereMap map;
  map.method = MapMethod::flow;
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

SphereMap stepped_flow_map(const RawMesh& mesh, const Vec3& origin, double time, double step, Backend& backend,
                           Monitor& monitor) {
  const auto field = backend.distance_field(mesh.vertices, mesh.faces);
  const int steps = std::max(1, int(std::lround(time / step)));
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
  const double tolerance = usual_star_shape_tolerance(mesh.vertices, mesh.faces, options.origin);
  result.star = star_shape_time(mesh.vertices, mesh.faces, options.origin, tolerance, backend, monitor);
  result.time = time > 0 ? time : result.star.upper;
  if (result.star.given_up)
    result.notes.push_back(
        fmt::format("The star-shape time is met all along an edge, and was proven only to {:.2g}, not to "
                    "{:.2g}: it lies between {:.9g} and {:.9g}.",
                    result.star.upper - result.star.lower, tolerance, result.star.lower, result.star.upper));
  const auto field = backend.distance_field(mesh.vertices, mesh.faces);
  result.sutures.threshold = suture_threshold * diagonal;
  const auto fields_on = [&](double level, const SphereGrid& grid, LevelSetReport& met, CellMeansReport& means,
                             SutureReport* sutures, const Eigen::Matrix3d& turn) {
    const LevelSet set{*field, box, options.origin, level};
    const auto positions = level_set_positions(set, grid, monitor, &met, turn);
    // The radial function of a body that is star-shaped as it is has no jumps, however steep it is.
    if (sutures && !(time == 0 && result.star.lower == 0))
      *sutures = find_sutures(positions, grid, result.sutures.threshold, [&](std::span<const Vec3> directions) {
        return level_set_points(set, directions, monitor).points;
      });
    return cell_mean_fields(set, mesh.vertices, mesh.faces, grid, positions, options.signed_dphi, {}, monitor, &means,
                            turn);
  };
  ExpandSurfaceOptions of_grid = options;
  of_grid.grid_degree = options.grid_degree > 0 ? options.grid_degree
                                                : std::max(level_set_grid_degree, surface_grid_degree(options.lmax));
  of_grid.estimate_aliasing = false;
  const auto finest = [&](const SphereGrid& grid, ExpandSurfaceReport&) {
    return fields_on(result.time, grid, result.level_set, result.averaged, &result.sutures.jumps,
                     Eigen::Matrix3d::Identity());
  };
  result.expansion = expand_surface(finest, of_grid, backend, monitor, &result.report);

  // On two grids of half the degree and one of a quarter. They are turned: an edge or a jump that runs along the rings or
  // meridians of one grid, which refining it would not show, does not run along the others'.
  const SphereCoefficients last = with_means(result.expansion);
  const auto coefficients_on = [&](double level, int degree, const EulerAngles& turn) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, degree);
    SphereCoefficients a(std::min(options.lmax, degree), last.fields);
    LevelSetReport met;
    CellMeansReport means;
    const std::vector<double> values = fields_on(level, grid, met, means, nullptr, rotation_matrix(turn));
    backend.sphere_transform(grid, a.lmax)->analyse(last.fields, values, a.values, monitor);
    return rotate(a, turn, monitor);
  };
  const int half = of_grid.grid_degree / 2;
  const SphereCoefficients one = coefficients_on(result.time, half, turns[0]),
                           other = coefficients_on(result.time, half, turns[1]),
                           quarter = coefficients_on(result.time, half / 2, turns[2]);
  auto [change, norms] = differences(last, one);
  result.report.aliasing = std::move(norms);
  const auto again = differences(last, other).first, before = differences(one, quarter).first;
  for (std::size_t l = 0; l < change.size(); ++l)
    for (std::size_t f = 0; f < 6; ++f) change[l][f] = std::max({change[l][f], again[l][f], before[l][f] / 3});
  change = with_neighbours(change);
  add_rounding(box, result.level_set, last, change);
  for (std::size_t l = 0; l < change.size(); ++l)
    for (std::size_t f = 0; f < 6; ++f)
      change[l][f] += (f == 1 || f == 2 ? result.averaged.missed_angle : result.averaged.missed_length) *
                      std::sqrt((2 * double(l) + 1) / (4 * std::numbers::pi));
  result.unsettled = unknown_share(result.level_set.unsettled_angle + result.averaged.unsettled_angle, box,
                                   brillouin_radius(mesh.vertices, mesh.faces, options.origin), options.lmax);
  result.failure =
      unsettled_sentence(result, change, std::uint64_t(result.report.rings) * std::uint64_t(result.report.ring_length));
  if (time == 0) {
    // T* lies between two bounds: as far beyond the upper one again, and thrice that, for what changes like a root.
    const double beyond = result.star.upper + 3 * (result.star.upper - result.star.lower);
    const auto moved = differences(coefficients_on(beyond, half, turns[1]), other).first;
    for (std::size_t l = 0; l < change.size(); ++l)
      for (std::size_t f = 0; f < 6; ++f) change[l][f] += moved[l][f];
  }
  for (std::size_t l = 0; l < change.size(); ++l)
    for (std::size_t f = 0; f < 6; ++f) change[l][f] += result.unsettled[l][f];
  result.uncertainty = std::move(change);

  if (options.lmax >= 2 * slope_from) {
    result.sutures.slope_from = slope_from;
    result.sutures.slope_to = options.lmax;
    for (int f = 0; f < last.fields; ++f) {
      const std::vector<double> s = power(last, f);
      const bool any = *std::min_element(s.begin() + slope_from, s.end()) > 0;
      result.sutures.slopes[std::size_t(f)] = any ? spectral_slope(s, slope_from, options.lmax) : std::nan("");
    }
  }
  return result;
}

int sheets_grid_degree(int lmax) {
  return std::max(sheet_grid_degree, surface_grid_degree(lmax));
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
    bool first = true; // the grid of the result comes before the one of the aliasing's estimate
    const auto sampler = [&](const SphereGrid& grid, ExpandSurfaceReport&) {
      auto fields = sheet_fields(level.vertices, level.faces, map.positions, grid, options.origin, options.signed_dphi,
                                 monitor, first ? &sheets : nullptr);
      first = false;
      return fields;
    };
    ExpandSurfaceOptions of_level = options;
    if (options.grid_degree == 0) of_level.grid_degree = sheets_grid_degree(options.lmax);
    of_level.estimate_aliasing = &level == &meshes.back(); // for the uncertainty
    result.expansion = expand_surface(sampler, of_level, backend, monitor, &result.report);
    result.sheets.push_back(sheets);
    result.levels.push_back(with_means(result.expansion));
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
        double off = std::max(std::abs(change) / 2, result.report.aliasing[std::size_t(l)][std::size_t(f)]);
        if (n > 2)
          off = std::max(off, std::abs(2. * change - (before.at(f, l, m) - result.levels[n - 3].at(f, l, m))));
        else
          off = std::max(off, std::abs(change));
        double& most = result.uncertainty[std::size_t(l)][std::size_t(f)];
        most = std::max(most, off);
      }
  add_rounding(bounding_box(mesh.vertices, mesh.faces), {}, last, result.uncertainty);
  put_means(result.expansion);
  return result;
}

} // namespace cowgpu
