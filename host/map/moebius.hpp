// Conformal maps of the sphere to itself, and which of them to take.
#pragma once

#include "host/mesh/closed_surface.hpp"

#include <complex>
#include <span>
#include <vector>

namespace cowgpu {

/// A unit vector in extended precision: clusters that a conformal map makes keep their shape until the last rounding.
/// The zero vector stands for a vertex of no face; everything below leaves it where it is.
using SpherePoint = Eigen::Matrix<long double, 3, 1>;

/// (2 Re w, 2 Im w, 1 - |w|^2) / (1 + |w|^2): the plane to the sphere, 0 to the north pole, infinity to the south pole.
/// Keeps the orientation: counter-clockwise in the plane is counter-clockwise seen from outside the sphere.
SpherePoint inverse_stereographic(const std::complex<long double>& w);

/// (1 - |c|^2) (x + c) / |x + c|^2 + c for |c| < 1: the conformal map of the sphere to itself that pushes away from -c
/// towards c, without rotation; -c in place of c undoes it.
SpherePoint moebius(const SpherePoint& x, const SpherePoint& c);

/// Applies the Moebius transformation after which sum_i weight_i x_i = 0 (weights add up to 1), by Newton's method
/// (A. Baden, K. Crane, M. Kazhdan, Computer Graphics Forum 37 (2018) 73). Such a transformation is unique up to
/// rotations and exists where no direction has half the weight. Returns the number of steps. Throws Error(map_failed)
/// where |sum| stays above 1e-14.
int centre(std::span<SpherePoint> x, std::span<const double> weights);

/// The rotation R that maximises sum_i weight_i (R x_i) . (vertex_i - c), c the weighted mean of the vertices: directions
/// on the sphere then look like directions from the middle of the body. Applied to x, and returned.
Eigen::Matrix3d align(std::span<SpherePoint> x, std::span<const double> weights, std::span<const Vec3> vertices);

/// In double precision, each of length 1 to rounding.
std::vector<Vec3> rounded(std::span<const SpherePoint> x);

} // namespace cowgpu
