// Random coefficients, and what a synthesis followed by an analysis may change in them.
#pragma once

#include "host/sphere_coefficients.hpp"

#include <cstdint>

namespace cowgpu {

/// Real and imaginary parts uniform in [-0.5, 0.5), a_l0 real: the upper 53 bits of std::mt19937_64(seed), in the order the
/// coefficients are held in, real part first. The same on every machine.
SphereCoefficients random_coefficients(int lmax, int fields, std::uint64_t seed);

/// Differences of two sets of coefficients of the same shape.
struct CoefficientError {
  double max = 0; ///< largest |b - a| over largest |a|
  double rms = 0; ///< sqrt(sum |b - a|^2 / sum |a|^2), all m from -l to l
};
/// NaN if a difference is not finite; 0 for a = b = 0.
CoefficientError compare(const SphereCoefficients& a, const SphereCoefficients& b);

/// What CoefficientError::max of a round trip may be: 1e-13 up to degree 64, 5e-13 at 512, 1e-12 at 1024, 3e-12 at 2048, 1e-11
/// at 4096; between these, and beyond the last two, a straight line in the logarithms of degree and bound.
double round_trip_bound(int lmax);

} // namespace cowgpu
