// Two sets of moments against each other, by the degree's norm or its a-priori bound.
#pragma once

#include "host/multipoles.hpp"

#include <cmath>
#include <complex>
#include <span>
#include <vector>

namespace cowgpu::test {

/// Error of one set of coefficients against another, without an estimate of what it should be.
struct BoundErrors {
  std::vector<double> relative; ///< of each degree
  double worst = 0;             ///< the largest of them; NaN if anything is not a number
  int worst_degree = 0;
};

/// For each degree sqrt(sum_m |a - b|^2) over the norm of degree l of b; where that norm is below 1e-3 of `bound[l]`, and for
/// the dipole always, over bound[l] (plan::degree_bound()). b(i) is the i-th coefficient in extended precision.
template <class Value>
BoundErrors compare_by_bound(const Multipoles& a, const Value& b, std::span<const double> bound) {
  BoundErrors errors;
  for (int l = 0; l <= a.lmax; ++l) {
    long double difference = 0, square = 0;
    for (int m = 0; m <= l; ++m) {
      const std::size_t i = Multipoles::index(a.lmax, l, m);
      const std::complex<long double> value = b(i), apart = std::complex<long double>(a.values[i]) - value;
      const long double weight = m == 0 ? 1 : 2;
      difference += weight * std::norm(apart);
      square += weight * std::norm(value);
    }
    const double limit = bound[std::size_t(l)], apart = double(std::sqrt(difference));
    double scale = double(std::sqrt(square));
    if (l == 1 || scale < 1e-3 * limit) scale = limit;
    // What is beyond the range of doubles beside the largest bound is no error.
    const double error = apart <= 1e-280 * bound[0] ? 0.0 : apart / scale;
    errors.relative.push_back(error);
    if (!std::isnan(errors.worst) && !(error <= errors.worst)) {
      errors.worst = error;
      errors.worst_degree = l;
    }
  }
  return errors;
}

inline BoundErrors compare_by_bound(const Multipoles& a, const Multipoles& b, std::span<const double> bound) {
  return compare_by_bound(
      a, [&](std::size_t i) { return std::complex<long double>(b.values[i]); }, bound);
}

/// Real and imaginary parts of b interleaved.
inline BoundErrors compare_by_bound(const Multipoles& a, std::span<const long double> b,
                                    std::span<const double> bound) {
  return compare_by_bound(
      a, [&](std::size_t i) { return std::complex(b[2 * i], b[2 * i + 1]); }, bound);
}
inline BoundErrors compare_by_bound(const Multipoles& a, const std::vector<long double>& b,
                                    std::span<const double> bound) {
  return compare_by_bound(a, std::span<const long double>(b), bound);
}

} // namespace cowgpu::test
