#include "host/flow/sutures.hpp"

#include "host/error.hpp"
#include "host/sphere_directions.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace cowgpu {

namespace {

constexpr int halvings = 16;
constexpr std::size_t pairs_at_once = 1 << 18;

/// Two neighbouring points of a grid, a and the one to its east or south, and the half of the arc between them over which F
/// moves by more.
struct Pair {
  std::size_t point;
  bool south;
  Vec3 direction[2], end[2];
  double moves() const { return (end[1] - end[0]).norm(); }
};

void keep_jumps(std::vector<Pair>& pairs, double threshold, const PointsInDirections& between) {
  for (int k = 0; k < halvings && !pairs.empty(); ++k) {
    std::vector<Vec3> middles;
    for (const Pair& pair : pairs) middles.push_back((pair.direction[0] + pair.direction[1]).normalized());
    const std::vector<Vec3> ends = between(middles);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      Pair pair = pairs[i];
      const bool first = (ends[i] - pair.end[0]).norm() > (pair.end[1] - ends[i]).norm();
      pair.direction[first] = middles[i];
      pair.end[first] = ends[i];
      if (pair.moves() > threshold) pairs[kept++] = pair;
    }
    pairs.resize(kept);
  }
}

} // namespace

SutureReport find_sutures(std::span<const double> positions, const SphereGrid& grid, double threshold,
                          const PointsInDirections& between) {
  const std::size_t n = grid.points(), length = std::size_t(grid.ring_length), rings = std::size_t(grid.rings);
  if (positions.size() != 3 * n || !(threshold > 0))
    throw Error(Fault::bad_argument,
                fmt::format("jumps above {} of {} numbers on {} points", threshold, positions.size(), n));
  const auto at = [&](std::size_t p) { return Vec3(positions[p], positions[n + p], positions[2 * n + p]); };
  const SphereDirections directions(grid);
  const auto direction = [&](std::size_t p) { return directions(int(p / length), int(p % length)); };
  SutureReport found;
  std::vector<std::uint8_t> jumps(n); // 1 to the east, 2 to the south
  std::vector<Pair> pairs;
  const auto settle = [&] {
    keep_jumps(pairs, threshold, between);
    for (const Pair& pair : pairs) {
      if (found.pairs++ == 0) found.low = found.high = pair.end[0];
      for (const Vec3& end : pair.end) {
        found.low = found.low.cwiseMin(end);
        found.high = found.high.cwiseMax(end);
      }
      jumps[pair.point] |= pair.south ? 2 : 1;
      if (!(pair.moves() > found.largest)) continue;
      found.largest = pair.moves();
      found.theta = grid.theta[pair.point / length];
      found.phi = grid.phi(int(pair.point % length));
    }
    pairs.clear();
  };
  for (std::size_t p = 0; p < n; ++p) {
    const auto compare = [&](std::size_t other, bool south) {
      if ((at(other) - at(p)).norm() > threshold)
        pairs.push_back({p, south, {direction(p), direction(other)}, {at(p), at(other)}});
    };
    compare(p / length * length + (p + 1) % length, false);
    if (p / length + 1 < rings) compare(p + length, true);
    if (pairs.size() >= pairs_at_once) settle();
  }
  settle();
  for (std::size_t p = 0; p < n; ++p) {
    if (!jumps[p]) continue;
    const std::size_t ring = p / length;
    const double down = ring + 1 < rings ? grid.theta[ring + 1] - grid.theta[ring] : 0,
                 along = 2 * std::numbers::pi / double(length) * std::sin(grid.theta[ring]);
    ++found.cells;
    found.length += std::hypot(jumps[p] & 1 ? down : 0, jumps[p] & 2 ? along : 0);
  }
  return found;
}

double spectral_slope(std::span<const double> power, int from, int to) {
  if (from < 1 || to <= from || std::size_t(to) >= power.size())
    throw Error(Fault::bad_argument, fmt::format("the slope of a spectrum of degrees 0 to {} from {} to {}",
                                                 std::ptrdiff_t(power.size()) - 1, from, to));
  double x = 0, y = 0, xx = 0, xy = 0;
  const double count = to - from + 1;
  for (int l = from; l <= to; ++l) {
    const double value = power[std::size_t(l)];
    if (!(value > 0)) throw Error(Fault::bad_argument, fmt::format("degree {} has no power: no slope", l));
    const double u = std::log(double(l)), v = std::log(value / (2 * l + 1));
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  return (xy - x * y / count) / (xx - x * x / count);
}

} // namespace cowgpu
