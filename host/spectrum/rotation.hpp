// Rotation of fields given by their spherical-harmonic coefficients.
#pragma once

#include "host/monitor.hpp"
#include "host/sphere_coefficients.hpp"

#include <Eigen/Core>

namespace cowgpu {

/// The rotation R = R_z(alpha) R_y(beta) R_z(gamma), radians, about fixed axes, the rightmost first; R_z(t) turns x towards
/// y, R_y(t) turns z towards x. Any real angles. An angle that is a multiple of pi / 2 rounded to double counts as that
/// multiple exactly.
struct EulerAngles {
  double alpha = 0, beta = 0, gamma = 0;

  /// The angles of R^-1.
  EulerAngles inverse() const { return {-gamma, -beta, -alpha}; }
};

/// R as a matrix that acts on columns.
Eigen::Matrix3d rotation_matrix(const EulerAngles& angles);

/// Angles of a matrix, beta in [0, pi], gamma = 0 where beta is 0 or pi. Throws Error(bad_argument) unless R R^T = 1 to
/// 1e-9 and det R > 0.
EulerAngles euler_angles(const Eigen::Matrix3d& rotation);

/// Coefficients of the rotated fields (Rf)(n) = f(R^-1 n): an active rotation, which carries the field along. With
/// Wigner's D-matrix in the convention of Sakurai, Rose and Varshalovich (Quantum Theory of Angular Momentum, 4.3),
///   (Ra)_lm = sum_{m'=-l..l} D^l_mm'(alpha, beta, gamma) a_lm',
///   D^l_mm' = exp(-i m alpha) d^l_mm'(beta) exp(-i m' gamma),  d^l_mm'(beta) = <l m| exp(-i beta J_y) |l m'>,
///   d^1_10 = -sin(beta) / sqrt(2).
/// Coefficients in a frame that is itself turned by R (passive) are those of rotate(a, angles.inverse()).
///
/// R_y(beta) = R_z(pi/2) R_y(pi/2) R_z(beta + pi) R_y(pi/2) R_z(pi/2), so that two turns by 90 degrees about y
/// (host/spectrum/quarter_turn.hpp) and factors of modulus one serve all angles: the error does not depend on beta, where
/// a recurrence at small beta loses l^2 times the rounding, and d(pi/2) costs half of d(beta), having a symmetry more.
/// Multiples of 90 degrees take none of them or one: turns about z and half turns only move and negate numbers.
///
/// Time O(lmax^3), memory beside input and result that of one QuarterTurn, O(lmax^2). The same bits for any number of
/// threads (0: all). lmax <= largest_grid_degree, else Error(bad_argument). Throws Error(interrupted).
SphereCoefficients rotate(const SphereCoefficients& coefficients, const EulerAngles& angles, Monitor& monitor,
                          unsigned threads = 0);

} // namespace cowgpu
