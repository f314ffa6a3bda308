#include "host/mesh/inscribed.hpp"

#include "host/mesh/winding.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace cowgpu {
namespace {

constexpr double tolerance = 1e-3;

struct Cell {
  Vec3 middle, half; ///< a box
  double bound;      ///< upper bound of the radii of balls centred in it
  std::uint32_t number;

  bool operator<(const Cell& other) const {
    return bound < other.bound || (bound == other.bound && number > other.number);
  }
};

} // namespace

std::optional<double> inscribed_radius(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree,
                                       const Bvh& boundary, const Vec3& about) {
  if (winding_number(tree, vertices, faces, about) <= 0) return std::nullopt;
  return std::sqrt(boundary.closest(about).distance2);
}

LargestBall largest_ball(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree,
                         const Bvh& boundary, Monitor& monitor, std::uint32_t most) {
  LargestBall best;
  if (tree.nodes().empty()) return best;
  std::uint32_t looked_at = 0;
  std::priority_queue<Cell> cells;
  const auto look = [&](const Vec3& middle, const Vec3& half, double bound_above) {
    const double distance = std::sqrt(boundary.closest(middle).distance2), reach = half.norm();
    ++looked_at;
    if (distance + reach <= best.radius) return;
    const bool inside = winding_number(tree, vertices, faces, middle) > 0;
    if (inside && distance > best.radius) best = {middle, distance, 0};
    const double bound = std::min(bound_above, reach + (inside ? distance : -distance));
    if (bound > best.radius) cells.push({middle, half, bound, looked_at});
  };
  const Vec3 low = tree.nodes()[0].low, high = tree.nodes()[0].high;
  const Vec3 half = high / 2 - low / 2;
  look(low + half, half, half.minCoeff());
  while (!cells.empty() && cells.top().bound > (1 + tolerance) * best.radius && looked_at < most) {
    if (looked_at % 512 < 2) {
      check_stop(monitor);
      monitor.progress("largest ball", double(looked_at) / most);
    }
    const Cell cell = cells.top();
    cells.pop();
    int axis = 0;
    cell.half.maxCoeff(&axis);
    Vec3 smaller = cell.half;
    smaller[axis] /= 2;
    for (const double side : {-1.0, 1.0}) {
      Vec3 middle = cell.middle;
      middle[axis] += side * smaller[axis];
      look(middle, smaller, cell.bound);
    }
  }
  best.bound = best.radius;
  if (!cells.empty()) best.bound = std::max(best.radius, cells.top().bound);
  return best;
}

} // namespace cowgpu
