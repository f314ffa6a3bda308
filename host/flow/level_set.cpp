#include "host/flow/level_set.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/spectrum/surface_fields.hpp"
#include "host/sphere_directions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace cowgpu {
namespace {

constexpr std::size_t batch = 1 << 18;
constexpr int most_passes = 100;
constexpr double jump_angle = 0.05, jump_length = 0.02; // radians, diagonals

/// One direction's search; `low` and `high` are radii known to be inside and outside the level set.
struct Ray {
  Vec3 direction;
  double radius, low, high;
  std::uint32_t at; ///< of the grid
};

} // namespace

std::vector<Vec3> level_set_points(DistanceField& field, const Vec3& low, const Vec3& high, const Vec3& origin,
                                   double level, std::span<const Vec3> directions, Monitor& monitor,
                                   LevelSetReport* report) {
  if (!(level > 0) || !std::isfinite(level))
    throw Error(Fault::bad_argument, fmt::format("a level set lies at a distance above 0, not {}", level));
  if (!origin.allFinite()) throw Error(Fault::bad_argument, "the origin of a level set's map must be finite");
  const auto start = Clock::now();
  const double diagonal = (high - low).norm(), enough = 1e-14 * diagonal;
  const double outside = (low - origin).cwiseAbs().cwiseMax((high - origin).cwiseAbs()).norm() + level;
  LevelSetReport own;
  LevelSetReport& found = report ? *report : own;
  std::vector<Vec3> ends(directions.size());
  for (std::size_t begin = 0; begin < directions.size(); begin += batch) {
    check_stop(monitor);
    std::vector<Ray> rays;
    for (std::size_t i = begin; i < std::min(begin + batch, directions.size()); ++i)
      rays.push_back({directions[i], outside, 0, outside, std::uint32_t(i)});
    for (int pass = 0; pass < most_passes && !rays.empty(); ++pass) {
      std::vector<Vec3> places;
      places.reserve(rays.size());
      for (const Ray& ray : rays) places.push_back(origin + ray.radius * ray.direction);
      const ClosestPoints closest = field.closest(places, {.with_sign = false}, monitor);
      found.queries += places.size();
      std::size_t kept = 0;
      for (std::size_t k = 0; k < rays.size(); ++k) {
        Ray ray = rays[k];
        const double d = closest.distance[k], gap = d - level;
        const double slope = d > 0 ? (places[k] - closest.point[k]).dot(ray.direction) / d : 0;
        (gap > 0 ? ray.high : ray.low) = ray.radius;
        const bool pinned = ray.high - ray.low <= 4e-16 * outside;
        if (std::abs(gap) <= enough || pinned || pass + 1 == most_passes) {
          ends[ray.at] = closest.point[k];
          found.largest_residual = std::max(found.largest_residual, std::abs(gap));
          found.least_slope = std::min(found.least_slope, slope);
          found.unsettled += std::abs(gap) > 1e-12 * diagonal;
          continue;
        }
        // A step within 0.9 d cannot cross the surface, so the unsigned distance is enough.
        double next = ray.radius - gap / slope;
        if (gap > 0) {
          if (!(slope > 0) || next <= ray.low || ray.radius - next > 0.9 * d)
            next = ray.radius - std::min(gap, 0.9 * d);
        } else if (!(slope > 0) || next >= ray.high) {
          // The far side of the ball about the closest point.
          const Vec3 from = origin - closest.point[k];
          const double b = from.dot(ray.direction), c = from.squaredNorm() - level * level;
          next = std::max(ray.radius, -b + std::sqrt(std::max(0.0, b * b - c)));
        }
        if (pass > 12 && !(next > ray.low && next < ray.high)) next = (ray.low + ray.high) / 2;
        if (pass > 24 && pass % 2) next = (ray.low + ray.high) / 2;
        ray.radius = next;
        rays[kept++] = ray;
      }
      rays.resize(kept);
    }
  }
  found.seconds += seconds_since(start);
  return ends;
}

std::vector<double> level_set_positions(DistanceField& field, const Vec3& low, const Vec3& high, const Vec3& origin,
                                        double level, const SphereGrid& grid, Monitor& monitor,
                                        LevelSetReport* report) {
  LevelSetReport found;
  const std::size_t points = grid.points(), length = std::size_t(grid.ring_length);
  std::vector<double> positions(3 * points);
  const SphereDirections directions(grid);
  const std::size_t rings_a_batch = std::max<std::size_t>(1, batch / length);
  for (std::size_t ring = 0; ring < std::size_t(grid.rings); ring += rings_a_batch) {
    monitor.progress("meeting the level set", double(ring) / double(grid.rings));
    std::vector<Vec3> some;
    for (std::size_t i = ring; i < std::min(std::size_t(grid.rings), ring + rings_a_batch); ++i)
      for (std::size_t j = 0; j < length; ++j) some.push_back(directions(int(i), int(j)));
    const std::vector<Vec3> ends = level_set_points(field, low, high, origin, level, some, monitor, &found);
    for (std::size_t k = 0; k < ends.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c) positions[c * points + ring * length + k] = ends[k][Eigen::Index(c)];
  }
  monitor.progress("meeting the level set", 1);
  if (report) *report = found;
  return positions;
}

std::vector<double> averaged_fields(DistanceField& field, const Vec3& low, const Vec3& high, const Vec3& origin,
                                    double level, const SphereGrid& grid, std::span<const double> positions,
                                    bool signed_dphi, int parts, Monitor& monitor, JumpReport* report) {
  const std::size_t n = grid.points(), length = std::size_t(grid.ring_length), rings = std::size_t(grid.rings);
  if (positions.size() != 3 * n || parts < 1)
    throw Error(Fault::bad_argument,
                fmt::format("means of {} x {} parts from {} numbers on {} points", parts, parts, positions.size(), n));
  std::vector<double> values =
      surface_fields(std::vector<double>(positions.begin(), positions.end()), grid, origin, signed_dphi);
  // Thresholds well above what the fields move by from point to point elsewhere.
  const double angle = jump_angle, moved = jump_length * (high - low).norm();
  std::vector<bool> jumps(n);
  const auto compare = [&](std::size_t a, std::size_t b) {
    for (std::size_t f = 0; f < 6; ++f)
      if (std::abs(values[f * n + a] - values[f * n + b]) > (f == 1 || f == 2 ? angle : moved)) {
        jumps[a] = jumps[b] = true;
        return;
      }
  };
  for (std::size_t p = 0; p < n; ++p) {
    const std::size_t ring = p / length;
    compare(p, ring * length + (p + 1) % length);
    if (ring + 1 < rings) compare(p, p + length);
  }
  std::vector<double> edges = {1}; // cosines
  for (const double weight : grid.weights) edges.push_back(edges.back() - weight);
  edges.back() = -1;
  std::vector<std::size_t> cells;
  for (std::size_t p = 0; p < n; ++p)
    if (jumps[p]) cells.push_back(p);
  const std::size_t k = std::size_t(parts), each = k * k, cells_a_batch = std::max<std::size_t>(1, batch / each);
  const double step = 2 * std::numbers::pi / double(length);
  for (std::size_t begin = 0; begin < cells.size(); begin += cells_a_batch) {
    monitor.progress("averaging over jumps", double(begin) / double(cells.size()));
    const std::size_t end = std::min(cells.size(), begin + cells_a_batch);
    struct Part {
      double theta, phi;
    };
    std::vector<Part> where;
    std::vector<Vec3> directions;
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t ring = cells[i] / length;
      for (std::size_t part = 0; part < each; ++part) {
        const double across = (double(part / k) + 0.5) / double(k), along = (double(part % k) + 0.5) / double(k) - 0.5;
        const double z = std::clamp(edges[ring] + across * (edges[ring + 1] - edges[ring]), -1.0, 1.0);
        const double theta = std::acos(z), phi = grid.phi(int(cells[i] % length)) + along * step;
        where.push_back({theta, phi});
        directions.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), z);
      }
    }
    const std::vector<Vec3> ends = level_set_points(field, low, high, origin, level, directions, monitor);
    for (std::size_t i = begin; i < end; ++i) {
      std::array<double, 6> sum{};
      for (std::size_t part = 0; part < each; ++part) {
        const std::size_t at = (i - begin) * each + part;
        const auto of_part = surface_field_values(ends[at], origin, where[at].theta, where[at].phi, signed_dphi);
        for (std::size_t f = 0; f < 6; ++f) sum[f] += of_part[f] / double(each);
      }
      for (std::size_t f = 0; f < 6; ++f) values[f * n + cells[i]] = sum[f];
    }
  }
  if (report) *report = {cells.size(), n};
  return values;
}

} // namespace cowgpu
