#include "host/flow/level_set.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/sphere_directions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

constexpr std::size_t batch = 1 << 18;
constexpr int most_passes = 100;

/// One direction's search; `low` and `high` are radii known to be inside and outside the level set.
struct Ray {
  Vec3 direction;
  double radius, low, high;
  std::uint32_t at; ///< of the grid
};

} // namespace

std::vector<double> level_set_positions(DistanceField& field, const Vec3& low, const Vec3& high, const Vec3& origin,
                                        double level, const SphereGrid& grid, Monitor& monitor,
                                        LevelSetReport* report) {
  if (!(level > 0) || !std::isfinite(level))
    throw Error(Fault::bad_argument, fmt::format("a level set lies at a distance above 0, not {}", level));
  if (!origin.allFinite()) throw Error(Fault::bad_argument, "the origin of a level set's map must be finite");
  const auto start = Clock::now();
  const double diagonal = (high - low).norm(), enough = 1e-14 * diagonal;
  const double outside = (low - origin).cwiseAbs().cwiseMax((high - origin).cwiseAbs()).norm() + level;
  LevelSetReport found;
  const std::size_t points = grid.points(), length = std::size_t(grid.ring_length);
  std::vector<double> positions(3 * points);
  const SphereDirections directions(grid);

  const std::size_t rings_a_batch = std::max<std::size_t>(1, batch / length);
  for (std::size_t ring = 0; ring < std::size_t(grid.rings); ring += rings_a_batch) {
    check_stop(monitor);
    monitor.progress("meeting the level set", double(ring) / double(grid.rings));
    const std::size_t end = std::min(std::size_t(grid.rings), ring + rings_a_batch);
    std::vector<Ray> rays;
    for (std::size_t i = ring; i < end; ++i)
      for (std::size_t j = 0; j < length; ++j)
        rays.push_back({directions(int(i), int(j)), outside, 0, outside, std::uint32_t(i * length + j)});
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
        const double slope = (places[k] - closest.point[k]).dot(ray.direction) / d;
        (gap > 0 ? ray.high : ray.low) = ray.radius;
        const bool pinned = ray.high - ray.low <= 4e-16 * outside;
        if (std::abs(gap) <= enough || pinned || pass + 1 == most_passes) {
          for (std::size_t c = 0; c < 3; ++c) positions[c * points + ray.at] = closest.point[k][Eigen::Index(c)];
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
  monitor.progress("meeting the level set", 1);
  found.seconds = seconds_since(start);
  if (report) *report = found;
  return positions;
}

} // namespace cowgpu
