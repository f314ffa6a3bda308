#include "host/physics/equilibrium_bounds.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace cowgpu::physics {
namespace {

constexpr double four_pi = 4 * std::numbers::pi;
constexpr int parts_along = 6;

} // namespace

GravityBounds::GravityBounds(double density, double mass, const Vec3& low, const Vec3& high)
    : density_(density), mass_(mass), half_((high - low) / (2 * parts_along)) {
  for (int z = 0; z < parts_along; ++z)
    for (int y = 0; y < parts_along; ++y)
      for (int x = 0; x < parts_along; ++x)
        parts_.push_back(low + Vec3(2 * x + 1, 2 * y + 1, 2 * z + 1).cwiseProduct(half_));
}

double GravityBounds::change(double reach, double h) const {
  return density_ / 2 * h * (17.35 * std::log((reach + h) / h) + 18.8);
}

// Of all mass outside a ball of radius depth - h about x + d: the most that 6/r^4 adds up to where the mass fills the nearest
// parts of the box, each as densely as may be.
double GravityBounds::outer_third(const Vec3& x, double depth, double h) const {
  const double nearest = depth - h, part = density_ * 8 * half_.prod();
  std::array<double, std::size_t(parts_along * parts_along * parts_along)> distances{};
  for (std::size_t i = 0; i < distances.size(); ++i)
    distances[i] = std::max(((x - parts_[i]).cwiseAbs() - half_).cwiseMax(0).norm() - h, nearest);
  std::sort(distances.begin(), distances.end());
  double left = mass_, sum = 0;
  for (const double r : distances) {
    const double mass = std::min(left, part);
    sum += 6 * mass / (r * r * r * r);
    left -= mass;
    if (!(left > 0)) break;
  }
  // Rounding, or a mass that the box does not hold at this density.
  if (left > 0) sum += 6 * left / (nearest * nearest * nearest * nearest);
  return sum;
}

double GravityBounds::remainder(const Vec3& x, double depth, bool outside, double h) const {
  if (!(depth > h)) return std::numeric_limits<double>::infinity();
  double third = density_ / 2 * four_pi * 3.36 / (depth - h);
  if (outside) third = std::min(third, outer_third(x, depth, h));
  return third * h * h / 2;
}

double GravityBounds::gradient_change(const Vec3& x, double depth, bool outside, double h) const {
  if (!(depth > h)) return std::numeric_limits<double>::infinity();
  double third = density_ / 2 * four_pi * 6 / (depth - h);
  if (outside) third = std::min(third, outer_third(x, depth, h));
  return third * h;
}

double GravityBounds::injective_within(const Vec3& x, double depth, bool outside, double stiffness) const {
  double low = 0, high = depth;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (gradient_change(x, depth, outside, middle) < stiffness ? low : high) = middle;
  }
  return low;
}

double least_over_box(const Vec3& a, const Eigen::Matrix3d& gradient, const Vec3& half) {
  const auto apart = [&](const Vec3& normal) {
    return std::abs(normal.dot(a)) - (gradient * normal).cwiseAbs().dot(half);
  };
  double best = 0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solved(gradient);
  for (int k = 0; k < 3; ++k) best = std::max(best, apart(solved.eigenvectors().col(k)));
  // Projected gradient steps towards the point of the box whose image is nearest to 0; each image gives a normal.
  const double step = 1 / std::max(solved.eigenvalues().cwiseAbs2().maxCoeff(), std::numeric_limits<double>::min());
  Vec3 d = Vec3::Zero();
  for (int i = 0; i < 4; ++i) {
    const Vec3 image = a + gradient * d;
    const double length = image.norm();
    if (!(length > 0)) break;
    best = std::max(best, apart(image / length));
    d = (d - step * (gradient * image)).cwiseMax(-half).cwiseMin(half);
  }
  return best;
}

} // namespace cowgpu::physics
