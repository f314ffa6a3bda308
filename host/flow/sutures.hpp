// Where a map to the surface jumps: rays from two sides of the medial axis end far apart.
#pragma once

#include "host/sphere_grid.hpp"
#include "host/types.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace cowgpu {

struct SutureReport {
  std::uint64_t pairs = 0;   ///< neighbouring grid points whose F are farther apart than the threshold
  std::uint64_t cells = 0;   ///< points with such a neighbour to the east or to the south
  double length = 0;         ///< radians along the sphere, counted in cell sides and diagonals: up to 8 % too long
  double largest = 0;        ///< jump of F
  double theta = 0, phi = 0; ///< where that is
  Vec3 low = Vec3::Zero(), high = Vec3::Zero(); ///< box round the surface points on either side of jumps
};

/// F for directions (unit vectors), in their order.
using PointsInDirections = std::function<std::vector<Vec3>(std::span<const Vec3>)>;

/// `positions`: x, y, z of F, [3][ring][longitude]. The threshold is a length well above what F moves by from point to point
/// on most of the sphere. Where F moves by more, `between` is asked in the middle of the two directions, and again in the
/// middle of the half over which F moves by more, 16 times: where it then still moves by more than the threshold it jumps; else
/// it is steep, and the pair is not counted. Throws Error(bad_argument) for sizes that do not fit.
SutureReport find_sutures(std::span<const double> positions, const SphereGrid& grid, double threshold,
                          const PointsInDirections& between);

/// Slope of log(S_l / (2 l + 1)) over log l by least squares, l = from ... to: a field that jumps along curves falls like
/// l^-3, a smooth one faster than any power. `power` as power() gives it. Throws Error(bad_argument) unless
/// 1 <= from < to < size and every S_l > 0.
double spectral_slope(std::span<const double> power, int from, int to);

} // namespace cowgpu
