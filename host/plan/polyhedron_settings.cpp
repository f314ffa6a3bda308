#include "host/plan/polyhedron_settings.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::plan {

namespace {

// Area over that of the ball of the same volume, times the ratio of their radii: 1 for a ball, large for plates, needles and
// shells, whose faces on both sides cancel in the sums.
double thinness(const PolyhedronProblem& problem) {
  if (problem.faces.empty()) return 1;
  const Vec3 origin = problem.vertices[problem.faces[0][0]];
  double area = 0, volume = 0;
  for (const Face& face : problem.faces) {
    const Vec3 a = problem.vertices[face[0]] - origin, b = problem.vertices[face[1]] - origin,
               c = problem.vertices[face[2]] - origin;
    area += (b - a).cross(c - a).norm() / 2;
    volume += a.dot(b.cross(c)) / 6;
  }
  return area * std::cbrt(3 * std::abs(volume) / (4 * std::numbers::pi)) / (3 * std::abs(volume));
}

constexpr double thinnest_in_single = 3;

} // namespace

FastSettings fast_settings(const PolyhedronProblem& problem) {
  const double digits = -std::log10(problem.tolerance);
  FastSettings settings{};
  // Pairs' errors cancel: with these orders and shares (10, 15 and 20 at 1e-6, 1e-9 and 1e-12) the largest error was at most
  // 0.61 of the tolerance at the 88,320 centroids of a cow, and 0.8 of it at 353,280 (bench/polyhedron_fast.md). Bounds do not
  // cancel, and their shares are where a search begins.
  const double first = problem.guarantee ? 15 : 10;
  settings.order = std::clamp(int(std::lround(first + (digits - 6) * 5 / 3)), 4, largest_fast_order);
  settings.tau = problem.tolerance * (problem.guarantee ? 1. / 170 : 0.4 * std::pow(10, (digits - 6) / 15));
  settings.near = digits > 9.5 ? NearDigits::full : digits > 6.01 ? NearDigits::nine : NearDigits::single;
  // What is proven holds for the values too, as far as doubles go.
  if (problem.guarantee) settings.near = NearDigits::full;
  // The rounding of single precision is a part of the layers on the faces, which thin bodies have more of than gravity.
  if (settings.near == NearDigits::single &&
      (problem.derivatives == Derivatives::second || !(thinness(problem) <= thinnest_in_single)))
    settings.near = NearDigits::nine;
  return settings;
}

bool fast_sum_pays(const PolyhedronProblem& problem, std::uint64_t points) {
  // Without volume no error is small enough, so that all pairs would be near.
  if (problem.tolerance == 0 || !std::isfinite(thinness(problem))) return false;
  // In the time of one face at one point in the direct sum, with AVX2, as bench/polyhedron_fast.md has it: 1e-6, 1e-9 and 1e-12
  // were measured. Where points lie apart a point's share grows with the faces between two of them.
  double digits = std::max(6.0, -std::log10(problem.tolerance));
  if (problem.derivatives == Derivatives::second) digits = std::max(digits, 8.0);
  if (problem.guarantee) digits += 1;
  const double a_face = 85 + 33 * (digits - 6), a_point = 130 + 145 * (digits - 6), of_both = 110 + 65 * (digits - 6);
  const double faces = double(problem.faces.size()), all = double(points);
  return faces * all > a_face * faces + a_point * all + of_both * std::sqrt(faces * all);
}

} // namespace cowgpu::plan
