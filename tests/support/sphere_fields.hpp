// Fields on the sphere with known values: random coefficients, and plain sums in 80-bit arithmetic.
#pragma once

#include "host/spectrum/directions.hpp"
#include "host/sphere_coefficients.hpp"

#include <cstdint>

namespace cowgpu::test {

/// Normally distributed coefficients, those of m = 0 real.
SphereCoefficients random_coefficients(int lmax, int fields, std::uint32_t seed);

/// Root of the mean square of field f over the sphere: the scale of its values.
double field_scale(const SphereCoefficients& coefficients, int f = 0);

/// A field and its derivatives at one place.
struct FieldAt {
  long double value = 0, d_theta = 0, d_phi = 0;
};

/// Sums over all (l, m) of reference::legendre_column<long double>.
FieldAt field_at(const SphereCoefficients& coefficients, int f, const Direction& direction);

/// Largest |a - b| over the largest |b|.
double largest_difference(const SphereCoefficients& a, const SphereCoefficients& b);

} // namespace cowgpu::test
