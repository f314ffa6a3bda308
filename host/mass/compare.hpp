// How far two sets of moments are apart, degree by degree, beside what rounding explains.
#pragma once

#include "host/multipoles.hpp"

#include <span>
#include <vector>

namespace cowgpu {

/// One set of coefficients against another.
struct DegreeErrors {
  std::vector<double> difference; ///< norm of each degree of a - b: sqrt(sum_m |a - b|^2), all orders
  std::vector<double> norm;       ///< norm of each degree of b
  double ratio = 0;               ///< the largest difference over its estimate; NaN if anything is not a number
  int degree = 0;                 ///< where that is

  /// difference over norm at `degree`: infinite where the norm is zero and the difference is not.
  double relative() const;
};

/// Compares each degree with `estimate[l]`, the error to be expected of both together in the units of the coefficients
/// (host/mass/error_estimate.hpp). Both sets must be of one lmax, origin and radius.
DegreeErrors compare(const Multipoles& a, const Multipoles& b, std::span<const double> estimate);

/// The same against coefficients in extended precision, real and imaginary parts interleaved.
DegreeErrors compare(const Multipoles& a, std::span<const long double> b, std::span<const double> estimate);

} // namespace cowgpu
