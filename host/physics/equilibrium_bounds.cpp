#include "host/physics/equilibrium_bounds.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cowgpu::physics {
namespace {

constexpr double four_pi = 4 * std::numbers::pi;

} // namespace

double GravityBounds::change(double reach, double h) const {
  return density / 2 * h * (17.35 * std::log((reach + h) / h) + 18.8);
}

double GravityBounds::remainder(double depth, bool outside, double h) const {
  const double left = depth - h;
  if (!(left > 0)) return std::numeric_limits<double>::infinity();
  double third = density / 2 * four_pi * 3.36 / left;
  if (outside) third = std::min(third, 6 * mass / (left * left * left * left));
  return third * h * h / 2;
}

double GravityBounds::gradient_change(double depth, bool outside, double h) const {
  const double left = depth - h;
  if (!(left > 0)) return std::numeric_limits<double>::infinity();
  double third = density / 2 * four_pi * 6 / left;
  if (outside) third = std::min(third, 6 * mass / (left * left * left * left));
  return third * h;
}

double GravityBounds::injective_within(double depth, bool outside, double stiffness) const {
  double low = 0, high = depth;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (gradient_change(depth, outside, middle) < stiffness ? low : high) = middle;
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
