#include "host/flow/level_set.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/sphere_directions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu {
namespace {

constexpr std::size_t batch = 1 << 18;
constexpr int most_passes = 200, careful_passes = 12, patient_passes = 30;

/// One direction's search. Signed distance less the level, g, is below 0 at `low` and not below 0 at `high`, always.
struct RayToLevel {
  Vec3 direction;
  double radius, low, high;
  double width;         ///< width of the bracket when it was last cut in its middle
  double reach = 0;     ///< about the last place: the ball of this radius does not meet the surface
  double last = 0;      ///< radius of that place
  int side = 0;         ///< side of that place: 1 outside the body, -1 inside, 0 not known
  std::uint32_t at = 0; ///< of the directions
};

/// What is known at a place: the signed distance where its sign matters.
struct Met {
  double gap, slope; ///< g, and its derivative along the ray
  double distance;
};

class Search {
public:
  Search(const LevelSet& set, Monitor& monitor, LevelSetReport& report)
      : field_(set.field), origin_(set.origin), level_(set.level), monitor_(monitor), found_(report) {
    const Vec3 &low = set.box.min, &high = set.box.max;
    const double diagonal = (high - low).norm();
    const double size = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
    outside_ = (1 + 1e-9) * ((low - origin_).cwiseAbs().cwiseMax((high - origin_).cwiseAbs()).norm() + level_);
    enough_ = 1e-14 * diagonal;
    rounding_ = 4e-16 * std::max(diagonal, size);
    settled_ = std::max(1e-9 * diagonal, 1e-14 * size);
    require_origin_within();
  }

  LevelSetPoints run(std::span<const Vec3> directions) {
    LevelSetPoints ends;
    ends.points.resize(directions.size());
    for (std::size_t begin = 0; begin < directions.size(); begin += batch) {
      check_stop(monitor_);
      std::vector<RayToLevel> rays;
      for (std::size_t i = begin; i < std::min(begin + batch, directions.size()); ++i) {
        // Any surface point is nearer to the origin than `outside_` by more than the level.
        RayToLevel ray{directions[i], outside_, 0, outside_, outside_};
        ray.at = std::uint32_t(i);
        rays.push_back(ray);
      }
      for (int pass = 0; pass < most_passes && !rays.empty(); ++pass) step(rays, pass, ends);
    }
    return ends;
  }

private:
  void require_origin_within() {
    const ClosestPoints closest = field_.closest(std::span(&origin_, 1), {}, monitor_);
    ++found_.queries;
    if (closest.distance[0] < level_) return;
    throw Error(
        Fault::bad_argument,
        fmt::format("the origin ({:.6g}, {:.6g}, {:.6g}) lies {:.6g} from the body and the level set at {:.6g}: "
                    "rays from it do not start inside the level set, and some miss it; take a --time above the "
                    "first, --time auto, or an --origin inside the body",
                    origin_.x(), origin_.y(), origin_.z(), closest.distance[0], level_));
  }

  void step(std::vector<RayToLevel>& rays, int pass, LevelSetPoints& ends) {
    std::vector<Vec3> places;
    places.reserve(rays.size());
    for (const RayToLevel& ray : rays) places.push_back(origin_ + ray.radius * ray.direction);
    const ClosestPoints closest = field_.closest(places, {.with_sign = false}, monitor_);
    found_.queries += places.size();
    find_sides(rays, places, closest);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      RayToLevel ray = rays[k];
      const double d = closest.distance[k], sign = ray.side < 0 ? -1 : 1, gap = sign * d - level_;
      const double slope = d > 0 ? sign * (places[k] - closest.point[k]).dot(ray.direction) / d : 0;
      (gap >= 0 ? ray.high : ray.low) = ray.radius;
      const bool pinned = ray.high - ray.low <= 4e-16 * outside_, last = pass + 1 == most_passes;
      if (std::abs(gap) <= enough_ * std::clamp(100 * slope, 0.0, 1.0) || pinned || last) {
        ends.points[ray.at] = closest.point[k];
        found_.largest_residual = std::max(found_.largest_residual, std::abs(gap));
        found_.least_slope = std::min(found_.least_slope, slope);
        // By the bracket, or by the distance left and the slope that it falls with.
        const double width = ray.high - ray.low, left = std::abs(gap);
        const double known_to = std::min(width, left == 0 ? 0 : slope > 0 ? left / slope : width);
        if (!(known_to <= settled_) || !(left <= settled_)) {
          ++found_.unsettled;
          ends.unsettled.push_back(ray.at);
        } else {
          const double off = slope > 0 ? std::min(settled_, (left + rounding_) / slope) : settled_;
          found_.place_error = std::max(found_.place_error, off);
          found_.angle_error = std::max(found_.angle_error, off / (off + (closest.point[k] - origin_).norm()));
        }
        continue;
      }
      ray.radius = next_radius(ray, {gap, slope, d}, closest.point[k], pass);
      rays[kept++] = ray;
    }
    rays.resize(kept);
  }

  // Beyond the level from the surface the side decides whether a place is inside the level set or outside of it. It stays
  // as it was within a ball that the surface does not meet; else it is asked for.
  void find_sides(std::vector<RayToLevel>& rays, const std::vector<Vec3>& places, const ClosestPoints& closest) {
    std::vector<Vec3> asked;
    std::vector<std::size_t> rays_of;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      RayToLevel& ray = rays[k];
      if (!(std::abs(ray.radius - ray.last) < ray.reach)) ray.side = 0;
      ray.last = ray.radius;
      ray.reach = closest.distance[k];
      if (ray.radius == outside_) ray.side = 1;
      if (ray.side != 0 || closest.distance[k] < level_ - enough_) continue;
      asked.push_back(places[k]);
      rays_of.push_back(k);
    }
    if (asked.empty()) return;
    const ClosestPoints sides = field_.closest(asked, {}, monitor_);
    found_.queries += asked.size();
    for (std::size_t i = 0; i < asked.size(); ++i) rays[rays_of[i]].side = sides.winding[i] > 0 ? -1 : 1;
  }

  // Newton's step where it stays in the bracket; the bracket's middle where three steps have not halved it.
  double next_radius(RayToLevel& ray, const Met& met, const Vec3& closest, int pass) const {
    const double newton = ray.radius - met.gap / met.slope;
    double next = newton;
    if (met.gap > 0) {
      // Within 0.9 d of a place no step crosses the surface: at first the outermost sheet is looked for.
      const bool wide = pass < careful_passes && ray.radius - newton > 0.9 * met.distance;
      if (!(met.slope > 0) || !(newton > ray.low) || wide) next = ray.radius - std::min(met.gap, 0.9 * met.distance);
    } else if (!(met.slope > 0) || !(newton < ray.high)) {
      // g changes no faster than the place; and the ball of the level's radius about the closest point is inside.
      const Vec3 from = origin_ - closest;
      const double b = from.dot(ray.direction), c = from.squaredNorm() - level_ * level_;
      next = std::max(ray.radius - met.gap, -b + std::sqrt(std::max(0.0, b * b - c)));
    }
    const bool cut = pass >= careful_passes && (pass % 3 == 2 || pass > patient_passes);
    if (cut && ray.high - ray.low > ray.width / 2) next = (ray.low + ray.high) / 2;
    if (cut) ray.width = ray.high - ray.low;
    return next > ray.low && next < ray.high ? next : (ray.low + ray.high) / 2;
  }

  DistanceField& field_;
  const Vec3 origin_;
  const double level_;
  Monitor& monitor_;
  LevelSetReport& found_;
  double outside_ = 0, enough_ = 0, settled_ = 0, rounding_ = 0;
};

} // namespace

LevelSetPoints level_set_points(const LevelSet& set, std::span<const Vec3> directions, Monitor& monitor,
                                LevelSetReport* report) {
  if (!(set.level > 0) || !std::isfinite(set.level))
    throw Error(Fault::bad_argument, fmt::format("a level set lies at a distance above 0, not {}", set.level));
  if (!set.origin.allFinite()) throw Error(Fault::bad_argument, "the origin of a level set's map must be finite");
  const auto start = Clock::now();
  LevelSetReport own;
  LevelSetReport& found = report ? *report : own;
  LevelSetPoints ends = Search(set, monitor, found).run(directions);
  found.seconds += seconds_since(start);
  return ends;
}

std::vector<double> level_set_positions(const LevelSet& set, const SphereGrid& grid, Monitor& monitor,
                                        LevelSetReport* report, const Eigen::Matrix3d& turn) {
  LevelSetReport found;
  const std::size_t points = grid.points(), length = std::size_t(grid.ring_length);
  std::vector<double> positions(3 * points);
  const SphereDirections directions(grid);
  const std::size_t rings_a_batch = std::max<std::size_t>(1, batch / length);
  for (std::size_t ring = 0; ring < std::size_t(grid.rings); ring += rings_a_batch) {
    monitor.progress("meeting the level set", double(ring) / double(grid.rings));
    std::vector<Vec3> some;
    for (std::size_t i = ring; i < std::min(std::size_t(grid.rings), ring + rings_a_batch); ++i)
      for (std::size_t j = 0; j < length; ++j) some.emplace_back(turn * directions(int(i), int(j)));
    const LevelSetPoints ends = level_set_points(set, some, monitor, &found);
    for (std::size_t k = 0; k < some.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c) positions[c * points + ring * length + k] = ends.points[k][Eigen::Index(c)];
    for (const std::uint32_t k : ends.unsettled)
      found.unsettled_angle += grid.weights[ring + k / length] * 2 * std::numbers::pi / double(length);
  }
  monitor.progress("meeting the level set", 1);
  if (report) *report = found;
  return positions;
}

} // namespace cowgpu
