#include "host/spectrum/power.hpp"

#include <algorithm>

namespace cowgpu {

std::vector<double> power(const SphereCoefficients& coefficients, int field) {
  return cross_power(coefficients, field, coefficients, field);
}

std::vector<double> cross_power(const SphereCoefficients& a, int field_a, const SphereCoefficients& b, int field_b) {
  const int lmax = std::min(a.lmax, b.lmax);
  std::vector<double> sums(std::size_t(lmax) + 1);
  for (int l = 0; l <= lmax; ++l) sums[std::size_t(l)] = a.at(field_a, l, 0).real() * b.at(field_b, l, 0).real();
  for (int m = 1; m <= lmax; ++m)
    for (int l = m; l <= lmax; ++l) {
      const std::complex<double> x = a.at(field_a, l, m), y = b.at(field_b, l, m);
      sums[std::size_t(l)] += 2 * (x.real() * y.real() + x.imag() * y.imag()); // m and -m
    }
  return sums;
}

} // namespace cowgpu
