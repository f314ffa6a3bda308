// Small motions about an equilibrium of a spinning body.
#pragma once

#include "host/types.hpp"

#include <Eigen/Core>

#include <array>
#include <complex>
#include <string_view>
#include <vector>

namespace cowgpu::physics {

/// How a particle near an equilibrium moves, by the linearised equations d'' + 2 w x d' = (dd W) d.
enum class EquilibriumKind {
  stable,   ///< three oscillations, none of which grows
  saddle,   ///< at least one motion leaves it without turning
  spiral,   ///< motions leave it in growing oscillations
  marginal, ///< an eigenvalue is 0 to rounding: equilibria that are not isolated, or about to appear
};

/// "stable", "saddle" (leaves by exponentials), "spiral" (by growing oscillations), "marginal".
std::string_view name(EquilibriumKind kind);

struct SmallMotions {
  EquilibriumKind kind = EquilibriumKind::marginal;
  /// Squares of the six eigenvalues +-s, in pairs: roots of
  ///   q^3 + (4 w^2 - tr J) q^2 + (m - 4 w^2 J_ww) q - det J,
  /// J = dd W, m the sum of its principal minors of order 2, J_ww along the spin's axis.
  std::array<std::complex<double>, 3> squares;
  std::vector<double> frequencies; ///< rad/s, of the pure oscillations, rising
  double growth = 0;               ///< 1/s, the largest real part of an eigenvalue; 0 where stable
  double growth_frequency = 0;     ///< rad/s, with which that motion turns
  Vec3 stiffness = Vec3::Zero();   ///< eigenvalues of dd W, rising
  int index = 0;                   ///< sign of det dd W; 0 where marginal
};

SmallMotions small_motions(const Eigen::Matrix3d& gradient, const Vec3& axis, double rate);

} // namespace cowgpu::physics
