#include "host/physics/equilibrium_stability.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace cowgpu::physics {
namespace {

// Two roots that meet are known to the square root of rounding.
constexpr double double_root = 1e-7;
// Of the largest eigenvalue of dd W: what rounding leaves of one that is 0.
constexpr double vanishing = 1e-9;

} // namespace

std::string_view name(EquilibriumKind kind) {
  switch (kind) {
  case EquilibriumKind::stable: return "stable";
  case EquilibriumKind::saddle: return "saddle";
  case EquilibriumKind::spiral: return "spiral";
  case EquilibriumKind::marginal: break;
  }
  return "marginal";
}

SmallMotions small_motions(const Eigen::Matrix3d& gradient, const Vec3& axis, double rate) {
  SmallMotions found;
  found.stiffness = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(gradient, Eigen::EigenvaluesOnly).eigenvalues();
  const double square = rate * rate, scale = found.stiffness.cwiseAbs().maxCoeff() + square;
  if (!(scale > 0)) return found;
  const Vec3 k = found.stiffness / scale;
  const double turn = 4 * square / scale, along = axis.dot(gradient * axis) / scale;
  const double minors = k[0] * k[1] + k[1] * k[2] + k[2] * k[0];
  Eigen::Matrix3d companion = Eigen::Matrix3d::Zero();
  companion(1, 0) = companion(2, 1) = 1;
  companion.col(2) = Vec3(k.prod(), -(minors - turn * along), -(turn - k.sum()));
  const Eigen::Vector3cd roots = companion.eigenvalues();
  double largest = 0;
  for (const auto& q : roots) largest = std::max(largest, std::abs(q));
  found.index = k.cwiseAbs().minCoeff() < vanishing ? 0 : k.prod() > 0 ? 1 : -1;
  bool spiral = false, saddle = false;
  for (int i = 0; i < 3; ++i) {
    std::complex<double> q = roots[i];
    if (std::abs(q.imag()) < double_root * largest) q = q.real();
    found.squares[std::size_t(i)] = q * scale;
    const std::complex<double> s = std::sqrt(q * scale);
    if (q.imag() == 0 && q.real() < 0) {
      found.frequencies.push_back(std::sqrt(-q.real() * scale));
      continue;
    }
    (q.imag() == 0 ? saddle : spiral) = true;
    if (std::abs(s.real()) <= found.growth) continue;
    found.growth = std::abs(s.real());
    found.growth_frequency = std::abs(s.imag());
  }
  std::sort(found.frequencies.begin(), found.frequencies.end());
  found.kind = found.index == 0 ? EquilibriumKind::marginal
               : saddle         ? EquilibriumKind::saddle
               : spiral         ? EquilibriumKind::spiral
                                : EquilibriumKind::stable;
  return found;
}

} // namespace cowgpu::physics
