#include "host/flow/fixed_steps.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cowgpu {

std::vector<Vec3> flow_fixed_steps(DistanceField& field, std::span<const Vec3> starts, std::span<const Vec3> normals,
                                   double time, int steps, Monitor& monitor) {
  if (starts.size() != normals.size())
    throw Error(Fault::bad_argument,
                fmt::format("the flow has {} normals and {} starts: pass one normal for each start", normals.size(),
                            starts.size()));
  if (!(time >= 0) || !std::isfinite(time) || steps < 1)
    throw Error(
        Fault::bad_argument,
        fmt::format(
            "a flow cannot be computed for time {} in {} steps: pass a finite time of 0 or more, and 1 step or more",
            time, steps));
  const std::size_t n = starts.size();
  const double h = time / steps;
  std::vector<Vec3> x(starts.begin(), starts.end()), y(n), slope(n), sum(n);
  // The gradient at y; where y is on the surface, the last slope stays.
  const auto gradient = [&] {
    const ClosestPoints closest = field.closest(y, {.with_sign = false}, monitor);
    for (std::size_t i = 0; i < n; ++i)
      if (closest.distance[i] > 0) slope[i] = (y[i] - closest.point[i]) / closest.distance[i];
  };
  const auto stage = [&](double along, double weight) {
    for (std::size_t i = 0; i < n; ++i) y[i] = x[i] + along * h * slope[i];
    gradient();
    for (std::size_t i = 0; i < n; ++i) sum[i] += weight * slope[i];
  };
  for (int step = 0; step < steps; ++step) {
    check_stop(monitor);
    monitor.progress("flowing by fixed steps", double(step) / steps);
    y = x;
    if (step == 0) slope.assign(normals.begin(), normals.end());
    bool told = step == 0;
    for (std::size_t i = 0; told && i < n; ++i) told = slope[i].squaredNorm() > 0;
    if (!told) {
      const std::vector<Vec3> given = step == 0 ? slope : std::vector<Vec3>();
      gradient();
      for (std::size_t i = 0; i < given.size(); ++i)
        if (given[i].squaredNorm() > 0) slope[i] = given[i];
    }
    sum = slope;
    stage(0.5, 2);
    stage(0.5, 2);
    stage(1, 1);
    for (std::size_t i = 0; i < n; ++i) x[i] += h / 6 * sum[i];
  }
  monitor.progress("flowing by fixed steps", 1);
  return x;
}

} // namespace cowgpu
