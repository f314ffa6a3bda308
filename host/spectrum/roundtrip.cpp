#include "host/spectrum/roundtrip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace cowgpu {

SphereCoefficients random_coefficients(int lmax, int fields, std::uint64_t seed) {
  SphereCoefficients a(lmax, fields);
  std::mt19937_64 random(seed);
  const auto next = [&] { return std::ldexp(double(random() >> 11), -53) - 0.5; };
  for (int f = 0; f < fields; ++f)
    for (int m = 0; m <= lmax; ++m)
      for (int l = m; l <= lmax; ++l) {
        const double re = next();
        a.at(f, l, m) = {re, m > 0 ? next() : 0};
      }
  return a;
}

CoefficientError compare(const SphereCoefficients& a, const SphereCoefficients& b) {
  double largest = 0, worst = 0, sum = 0, error = 0;
  for (int f = 0; f < a.fields; ++f)
    for (int m = 0; m <= a.lmax; ++m)
      for (int l = m; l <= a.lmax; ++l) {
        const std::complex<double> x = a.at(f, l, m), d = b.at(f, l, m) - x;
        if (!std::isfinite(d.real()) || !std::isfinite(d.imag())) {
          constexpr double nan = std::numeric_limits<double>::quiet_NaN();
          return {nan, nan};
        }
        largest = std::max(largest, std::abs(x));
        worst = std::max(worst, std::abs(d));
        sum += (m > 0 ? 2 : 1) * std::norm(x);
        error += (m > 0 ? 2 : 1) * std::norm(d);
      }
  return {worst > 0 ? worst / largest : 0, error > 0 ? std::sqrt(error / sum) : 0};
}

double round_trip_bound(int lmax) {
  struct Point {
    double degree, bound;
  };
  constexpr std::array<Point, 5> table = {{{64, 1e-13}, {512, 5e-13}, {1024, 1e-12}, {2048, 3e-12}, {4096, 1e-11}}};
  if (lmax <= table[0].degree) return table[0].bound;
  std::size_t k = 1;
  while (k + 1 < table.size() && lmax > table[k].degree) ++k;
  const Point &low = table[k - 1], &high = table[k];
  const double part = std::log(lmax / low.degree) / std::log(high.degree / low.degree);
  return low.bound * std::pow(high.bound / low.bound, part);
}

} // namespace cowgpu
