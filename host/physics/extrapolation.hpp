// Ordinary differential equations to nearly all digits of extended precision.
#pragma once

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace cowgpu::physics {

using State = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// y' = slope(t, y).
using Slope = std::function<State(long double t, const State& y)>;

/// Entries of y that have a size of their own, so that a tiny angle keeps its digits beside a large distance: their norm, but at
/// least `least`, below which they are taken for rounding.
struct Block {
  std::vector<Eigen::Index> entries;
  long double least = 0;
};

/// y from t = `from` to t = `to` (either way) by the modified midpoint rule, extrapolated in the square of its step: Gragg,
/// Bulirsch and Stoer (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.9), to order 20. In each step the
/// error estimate of every block is within `tolerance` of its size. `step` is the first step to try, and becomes the one to
/// go on with; 0 tries the whole way. Throws Error(check_failed) where steps shrink to nothing, as they do when the tolerance
/// is below some 1e-17 or the slope is not smooth.
State extrapolate(const Slope& slope, State y, long double from, long double to, const std::vector<Block>& blocks,
                  long double& step, long double tolerance = 1e-16L);

} // namespace cowgpu::physics
