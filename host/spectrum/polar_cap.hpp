// Sums of associated Legendre functions next to the poles, where the common recurrences lose l^2 times the rounding.
//
// P_lm = N_lm sin^m(theta) R_{l-m}, N_lm = (-1)^m sqrt((2l+1)/4pi (l+m)!/(l-m)!) / (2^m m!), R Gegenbauer's polynomials for
// m + 1/2, 1 at the pole. With u = 1 - cos theta they follow by their differences (their three-term recurrence, DLMF
// 18.9.1, divided by their values at 1; for m = 0 the form of Reinsch), without cancellation:
//   D_{n+1} = ((l-m) D_n - (2l+1) u R_n) / (l+m+1),  R_{n+1} = R_n + D_{n+1},  n = l - m,  R_0 = 1, D_0 = 0.
#pragma once

#include "host/sphere_coefficients.hpp"

#include <complex>
#include <cstddef>
#include <vector>

namespace cowgpu {

/// Fields within sin(theta) <= sine(). Holds 16 (lmax + 1) * 67 bytes a field.
class PolarCap {
public:
  explicit PolarCap(int lmax);

  /// 16 / lmax, 0.5 at most.
  double sine() const { return sine_; }
  /// Orders m from here on stay below 1e-30 in the cap.
  int orders() const { return orders_; }

  /// Appends the coefficients' fields to those held.
  void add(const SphereCoefficients& coefficients);

  /// sum over l of a_lm P_lm(theta) of each field held, to sums[field]. `cosine` and `sine` are those of theta, which may
  /// be negative; |sine| <= sine().
  void sum(int m, long double cosine, long double sine, std::complex<double>* sums) const;

private:
  int lmax_, orders_;
  double sine_;
  std::vector<double> reciprocal_;                       ///< 1 / i
  std::vector<std::vector<std::complex<double>>> field_; ///< [field][m][l - m]: a_lm N_lm sine()^m
};

} // namespace cowgpu
