#include "host/spectrum/derivatives.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace cowgpu {

SphereCoefficients d_phi(const SphereCoefficients& coefficients) {
  SphereCoefficients result(coefficients.lmax, coefficients.fields);
  for (int f = 0; f < coefficients.fields; ++f)
    for (int m = 1; m <= coefficients.lmax; ++m)
      for (int l = m; l <= coefficients.lmax; ++l) {
        const std::complex<double> a = coefficients.at(f, l, m);
        result.at(f, l, m) = {-m * a.imag(), m * a.real()};
      }
  return result;
}

SphereCoefficients tilts(const SphereCoefficients& coefficients) {
  const int lmax = coefficients.lmax;
  SphereCoefficients result(lmax, 2 * coefficients.fields);
  for (int f = 0; f < coefficients.fields; ++f) {
    for (int l = 1; l <= lmax; ++l) {
      const std::complex<double> a = std::sqrt(l * (l + 1.0)) * coefficients.at(f, l, 1);
      result.at(2 * f, l, 0) = -a.real();
      result.at(2 * f + 1, l, 0) = a.imag();
    }
    for (int m = 1; m <= lmax; ++m)
      for (int l = m; l <= lmax; ++l) {
        std::complex<double> below = coefficients.at(f, l, m - 1);
        if (m == 1) below = below.real();
        const std::complex<double> u = 0.5 * std::sqrt((l + m) * (l - m + 1.0)) * below;
        const std::complex<double> v =
            l == m ? 0.0 : 0.5 * std::sqrt((l - m) * (l + m + 1.0)) * coefficients.at(f, l, m + 1);
        result.at(2 * f, l, m) = u - v;
        result.at(2 * f + 1, l, m) = {u.imag() + v.imag(), -(u.real() + v.real())};
      }
  }
  return result;
}

void synthesise_derivatives(SphereTransform& transform, int fields, std::span<const std::complex<double>> coefficients,
                            std::span<double> d_theta, std::span<double> d_phi, Monitor& monitor) {
  const int lmax = transform.lmax();
  const SphereGrid& grid = transform.grid();
  const std::size_t count = SphereCoefficients::count(lmax), points = grid.points();
  const auto size_is = [&](std::size_t size, std::size_t a_field) { return size == std::size_t(fields) * a_field; };
  if (fields < 0 || !size_is(coefficients.size(), count) || !(d_theta.empty() || size_is(d_theta.size(), points)) ||
      !(d_phi.empty() || size_is(d_phi.size(), points)))
    throw Error(
        Fault::bad_argument,
        fmt::format("derivatives of {} fields to degree {} on {} points take {} coefficients and {} values each, "
                    "not {}, {} and {}",
                    fields, lmax, points, std::size_t(std::max(fields, 0)) * count,
                    std::size_t(std::max(fields, 0)) * points, coefficients.size(), d_theta.size(), d_phi.size()));

  const auto length = std::size_t(grid.ring_length);
  std::vector<double> cosine(length), sine(length);
  for (std::size_t j = 0; j < length; ++j) {
    const long double phi = 2 * std::numbers::pi_v<long double> * (j + static_cast<long double>(grid.shift)) / length;
    cosine[j] = double(std::cos(phi));
    sine[j] = double(std::sin(phi));
  }

  constexpr int batch = most_fields / 2;
  for (int first = 0; first < fields; first += batch) {
    const int n = std::min(batch, fields - first);
    SphereCoefficients part(lmax, n);
    const auto from = coefficients.subspan(std::size_t(first) * count, std::size_t(n) * count);
    std::copy(from.begin(), from.end(), part.values.begin());
    if (!d_theta.empty()) {
      std::vector<double> both(std::size_t(2 * n) * points);
      transform.synthesise(2 * n, tilts(part).values, both, monitor);
      for (std::size_t f = 0; f < std::size_t(n); ++f) {
        const double *x = &both[2 * f * points], *y = x + points;
        double* out = &d_theta[(std::size_t(first) + f) * points];
        for (std::size_t i = 0; i < points; ++i) out[i] = cosine[i % length] * x[i] + sine[i % length] * y[i];
      }
    }
    if (!d_phi.empty())
      transform.synthesise(n, cowgpu::d_phi(part).values,
                           d_phi.subspan(std::size_t(first) * points, std::size_t(n) * points), monitor);
  }
  if (d_phi.empty()) return;
  for (std::size_t i = 0; i < std::size_t(grid.rings); ++i)
    if (grid.sine[i] == 0)
      for (std::size_t f = 0; f < std::size_t(fields); ++f) std::fill_n(&d_phi[f * points + i * length], length, 0.0);
}

} // namespace cowgpu
