#include "tests/support/sphere_fields.hpp"

#include "host/reference/sphere_transform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace cowgpu::test {

SphereCoefficients random_coefficients(int lmax, int fields, std::uint32_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  SphereCoefficients a(lmax, fields);
  for (int f = 0; f < fields; ++f)
    for (int m = 0; m <= lmax; ++m)
      for (int l = m; l <= lmax; ++l) {
        const double re = normal(random), im = normal(random);
        a.at(f, l, m) = {re, m == 0 ? 0 : im};
      }
  return a;
}

double field_scale(const SphereCoefficients& a, int f) {
  double sum = 0;
  for (int m = 0; m <= a.lmax; ++m)
    for (int l = m; l <= a.lmax; ++l) sum += (m == 0 ? 1 : 2) * std::norm(a.at(f, l, m));
  return std::sqrt(sum / (4 * std::numbers::pi));
}

FieldAt field_at(const SphereCoefficients& a, int f, const Direction& place) {
  using Real = long double;
  const auto column = [&](int m) {
    return m <= a.lmax ? reference::legendre_column<Real>(place.cosine, place.sine, m, a.lmax) : std::vector<Real>();
  };
  const Real phi = Real(place.phi) + place.phi_remainder;
  FieldAt sum;
  std::vector<Real> below, here = column(0);
  for (int m = 0; m <= a.lmax; ++m) {
    const std::vector<Real> above = column(m + 1);
    Real re = 0, im = 0, slope_re = 0, slope_im = 0;
    for (int l = m; l <= a.lmax; ++l) {
      const auto at = std::size_t(l - m);
      const Real p = here[at], up = l > m ? above[at - 1] : 0;
      const Real down = m > 0 ? below[at + 1] : l > 0 ? -above[at - 1] : 0; // P_l,-1 = -P_l1
      const Real slope =
          (std::sqrt(Real(l - m) * Real(l + m + 1)) * up - std::sqrt(Real(l + m) * Real(l - m + 1)) * down) / 2;
      const std::complex<double> value = a.at(f, l, m);
      re += value.real() * p;
      im += value.imag() * p;
      slope_re += value.real() * slope;
      slope_im += value.imag() * slope;
    }
    if (m == 0) im = slope_im = 0;
    const Real cosine = std::cos(m * phi), sine = std::sin(m * phi), twice = m == 0 ? 1 : 2;
    sum.value += twice * (re * cosine - im * sine);
    sum.d_theta += twice * (slope_re * cosine - slope_im * sine);
    sum.d_phi -= twice * m * (re * sine + im * cosine);
    below = std::move(here);
    here = above;
  }
  return sum;
}

double largest_difference(const SphereCoefficients& a, const SphereCoefficients& b) {
  double difference = 0, largest = 0;
  for (std::size_t i = 0; i < b.values.size(); ++i) {
    const double here = std::abs(a.values.at(i) - b.values[i]);
    if (!(here <= difference)) difference = here;
    largest = std::max(largest, std::abs(b.values[i]));
  }
  return difference / largest;
}

} // namespace cowgpu::test
