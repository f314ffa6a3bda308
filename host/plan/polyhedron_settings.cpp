#include "host/plan/polyhedron_settings.hpp"

#include <algorithm>

#include <cmath>

namespace cowgpu::plan {

FastSettings fast_settings(const PolyhedronProblem& problem) {
  const double digits = -std::log10(problem.tolerance);
  FastSettings settings{};
  // Pairs' errors cancel: at 1e-6, 1e-9 and 1e-12 these orders and shares leave the largest error of millions of points
  // below the tolerance. Their bounds do not, and have to be smaller by a factor that grows with the number of pairs.
  const double first = problem.guarantee ? 15 : 10;
  settings.order = std::clamp(int(std::lround(first + (digits - 6) * 5 / 3)), 4, largest_fast_order);
  settings.tau = problem.guarantee ? problem.tolerance / 170 : problem.tolerance / 4;
  settings.near = digits > 9.5 ? NearDigits::full : digits > 6.01 ? NearDigits::nine : NearDigits::single;
  if (problem.derivatives == Derivatives::second && settings.near == NearDigits::single)
    settings.near = NearDigits::nine;
  return settings;
}

bool fast_sum_pays(const PolyhedronProblem& problem, std::uint64_t points) {
  if (problem.tolerance == 0) return false;
  // In the time of one face at one point in the direct sum.
  const double digits = -std::log10(problem.tolerance), faces = double(problem.faces.size());
  const double a_face = 600, a_point = std::max(500.0, 800 + 430 * (digits - 6));
  return faces * double(points) > 1.2 * (a_face * faces + a_point * double(points));
}

} // namespace cowgpu::plan
