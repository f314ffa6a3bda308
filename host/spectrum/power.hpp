// Power of fields on the sphere, degree by degree.
#pragma once

#include "host/sphere_coefficients.hpp"

#include <vector>

namespace cowgpu {

/// S_l = sum over m = -l ... l of |a_lm|^2 for l = 0 ... lmax, in the square of the field's unit. With orthonormal
/// harmonics the S_l add up to the integral of f^2 over the unit sphere (Parseval). S_l / (2l + 1) is the power of one
/// coefficient.
std::vector<double> power(const SphereCoefficients& coefficients, int field = 0);

/// X_l = sum over m = -l ... l of conj(a_lm) b_lm for l = 0 ... lmax of the smaller of both, a and b real fields: the X_l
/// are real and add up to the integral of f g over the unit sphere, as far as their degrees go.
std::vector<double> cross_power(const SphereCoefficients& a, int field_a, const SphereCoefficients& b, int field_b);

} // namespace cowgpu
