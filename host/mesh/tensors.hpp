// Second and third moments of a body in Cartesian form.
#pragma once

#include "host/mesh/body.hpp"

#include <Eigen/Core>

#include <array>

namespace cowgpu {

/// Symmetric tensors about the body's origin, in mesh axes and density times length to the fifth power.
struct Tensors {
  Eigen::Matrix3d second_moment; ///< integral of density x_i x_j
  Eigen::Matrix3d quadrupole;    ///< integral of density (3 x_i x_j - r^2 delta_ij), traceless
  Eigen::Matrix3d inertia;       ///< integral of density (r^2 delta_ij - x_i x_j)
};

/// Exact up to rounding: the integral of x_i x_j over the tetrahedron (0, A, B, C) is det(A, B, C)/120 times
/// (S_i S_j + A_i A_j + B_i B_j + C_i C_j), S = A + B + C (Tonon 2004, "Explicit exact formulas for the 3-D tetrahedron
/// inertia tensor"). Summed about the middle of each surface's box and moved by Steiner's parallel-axis theorem.
Tensors tensors(const Body& body);

/// A tensor of three indices, [i](j, k).
using Tensor3 = std::array<Eigen::Matrix3d, 3>;

/// Integral of density x_i x_j x_k about the body's origin, in mesh axes: exact up to rounding, by the same reasoning. Over
/// the tetrahedron it is det(A, B, C)/720 times S_i S_j S_k + (S_i P_jk + S_j P_ik + S_k P_ij) + 2 T_ijk, with
/// S = A + B + C, P the sum of the three A_i A_j and T that of the three A_i A_j A_k.
Tensor3 third_moment(const Body& body);

} // namespace cowgpu
