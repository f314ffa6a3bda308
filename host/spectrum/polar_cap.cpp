#include "host/spectrum/polar_cap.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu {
namespace {

constexpr double widest = 16; // lmax sin(theta)
constexpr int most_orders = 67;

} // namespace

PolarCap::PolarCap(int lmax)
    : lmax_(lmax), orders_(std::min(lmax + 1, most_orders)), sine_(std::min(0.5, widest / std::max(1, lmax))) {
  reciprocal_.resize(std::size_t(2 * lmax) + 2);
  for (std::size_t i = 1; i < reciprocal_.size(); ++i) reciprocal_[i] = 1 / double(i);
}

void PolarCap::add(const SphereCoefficients& coefficients) {
  for (int f = 0; f < coefficients.fields; ++f) {
    auto& held = field_.emplace_back();
    long double first = 1 / std::sqrt(4 * std::numbers::pi_v<long double>); // N_mm sine^m
    for (int m = 0; m < orders_; ++m) {
      long double factor = first;
      for (int l = m; l <= lmax_; ++l) {
        const std::complex<double> a = coefficients.at(f, l, m);
        held.emplace_back(double(factor * a.real()), m == 0 ? 0 : double(factor * a.imag()));
        factor *= std::sqrt((2 * l + 3.0L) * (l + m + 1) / ((2 * l + 1.0L) * (l + 1 - m)));
      }
      first *= -std::sqrt((2 * m + 3.0L) / (2 * m + 2)) * sine_;
    }
  }
}

void PolarCap::sum(int m, long double cosine, long double sine, std::complex<double>* sums) const {
  const double u = double(sine * sine / (1 + std::fabs(cosine)));
  const double power = std::pow(double(sine / sine_), m),
               odd_sign = cosine < 0 ? -1 : 1; // P_lm is even or odd with l - m
  const std::size_t at = SphereCoefficients::index(lmax_, m, m);
  std::fill_n(sums, field_.size(), std::complex<double>());
  double r = 1, d = 0, sign = 1;
  for (int l = m; l <= lmax_; ++l, sign *= odd_sign) {
    for (std::size_t f = 0; f < field_.size(); ++f) sums[f] += sign * r * field_[f][at + std::size_t(l - m)];
    d = ((l - m) * d - (2 * l + 1) * (u * r)) * reciprocal_[std::size_t(l + m + 1)];
    r += d;
  }
  for (std::size_t f = 0; f < field_.size(); ++f) sums[f] *= power;
}

} // namespace cowgpu
