// Derivatives of fields on the sphere with respect to colatitude and longitude.
#pragma once

#include "host/monitor.hpp"
#include "host/sphere_coefficients.hpp"
#include "host/sphere_transform.hpp"

#include <complex>
#include <span>

namespace cowgpu {

/// df/dphi: i m a_lm.
SphereCoefficients d_phi(const SphereCoefficients& coefficients);

/// The fields X and Y with
///   df/dtheta = cos(phi) X + sin(phi) Y,
/// X and Y in turn for each field of the input. X is the change of f at a point that turns about y (z towards x), Y at a
/// point that turns from z towards y: i L_y f and -i L_x f. From
///   dP_lm/dtheta = (sqrt((l-m)(l+m+1)) P_{l,m+1} - sqrt((l+m)(l-m+1)) P_{l,m-1}) / 2
/// (Varshalovich, Moskalev, Khersonskii, Quantum Theory of Angular Momentum, 5.8.2), with
/// u_m = sqrt((l+m)(l-m+1)) a_{l,m-1} and v_m = sqrt((l-m)(l+m+1)) a_{l,m+1},
///   X_lm = (u_m - v_m) / 2,  Y_lm = -i (u_m + v_m) / 2.
/// Both are smooth, of the degree of f; nothing is divided by sin(theta).
SphereCoefficients tilts(const SphereCoefficients& coefficients);

/// df/dtheta and df/dphi of fields on the transform's grid, [field][ring][longitude], from their coefficients to degree
/// transform.lmax(); one span may be empty and is left out then. On a pole d_theta is the limit along the meridian of each
/// longitude (df along the direction in which the meridian leaves the north pole or reaches the south pole) and d_phi is
/// 0. Any number of fields; synthesises two for d_theta and one for d_phi each, and holds those of `most_fields` at most.
/// Throws what SphereTransform::synthesise() throws.
void synthesise_derivatives(SphereTransform& transform, int fields, std::span<const std::complex<double>> coefficients,
                            std::span<double> d_theta, std::span<double> d_phi, Monitor& monitor);

} // namespace cowgpu
