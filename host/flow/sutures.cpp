#include "host/flow/sutures.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace cowgpu {

SutureReport find_sutures(std::span<const double> positions, const SphereGrid& grid, double threshold) {
  const std::size_t n = grid.points(), length = std::size_t(grid.ring_length);
  if (positions.size() != 3 * n || !(threshold > 0))
    throw Error(Fault::bad_argument,
                fmt::format("jumps above {} of {} numbers on {} points", threshold, positions.size(), n));
  const auto at = [&](std::size_t p) { return Vec3(positions[p], positions[n + p], positions[2 * n + p]); };
  SutureReport found;
  for (std::size_t p = 0; p < n; ++p) {
    const std::size_t ring = p / length, j = p % length;
    const Vec3 here = at(p);
    bool across[2] = {};
    const auto compare = [&](std::size_t other, bool& jumps) {
      const Vec3 there = at(other);
      const double jump = (there - here).norm();
      if (!(jump > threshold)) return;
      jumps = true;
      if (found.pairs++ == 0) found.low = found.high = here;
      found.low = found.low.cwiseMin(here).cwiseMin(there);
      found.high = found.high.cwiseMax(here).cwiseMax(there);
      if (jump > found.largest) {
        found.largest = jump;
        found.theta = grid.theta[ring];
        found.phi = grid.phi(int(j));
      }
    };
    compare(ring * length + (j + 1) % length, across[0]);
    if (ring + 1 < std::size_t(grid.rings)) compare(p + length, across[1]);
    found.cells += across[0] || across[1];
    const double down = ring + 1 < std::size_t(grid.rings) ? grid.theta[ring + 1] - grid.theta[ring] : 0,
                 along = 2 * std::numbers::pi / double(length) * std::sin(grid.theta[ring]);
    found.length += std::hypot(across[0] ? down : 0, across[1] ? along : 0);
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
