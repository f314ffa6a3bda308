#include "host/spectrum/complex_fields.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

constexpr int batch = most_fields / 2; // complex fields a call

std::complex<double> signed_conjugate(std::complex<double> value, int m) {
  return m % 2 ? -std::conj(value) : std::conj(value);
}

} // namespace

SphereCoefficients split(const ComplexCoefficients& coefficients) {
  const int lmax = coefficients.lmax;
  SphereCoefficients parts(lmax, 2 * coefficients.fields);
  for (int f = 0; f < coefficients.fields; ++f)
    for (int m = 0; m <= lmax; ++m)
      for (int l = m; l <= lmax; ++l) {
        const std::complex<double> plus = coefficients.at(f, l, m);
        const std::complex<double> minus = signed_conjugate(coefficients.at(f, l, -m), m);
        const std::complex<double> difference = 0.5 * (plus - minus);
        parts.at(2 * f, l, m) = 0.5 * (plus + minus);
        parts.at(2 * f + 1, l, m) = {difference.imag(), -difference.real()};
      }
  return parts;
}

ComplexCoefficients join(const SphereCoefficients& parts) {
  if (parts.fields % 2)
    throw Error(
        Fault::bad_argument,
        fmt::format("{} real fields are no complex fields: give real and imaginary parts in turn", parts.fields));
  const std::complex<double> i(0, 1);
  ComplexCoefficients coefficients(parts.lmax, parts.fields / 2);
  for (int f = 0; f < coefficients.fields; ++f) {
    for (int l = 0; l <= parts.lmax; ++l)
      coefficients.at(f, l, 0) = {parts.at(2 * f, l, 0).real(), parts.at(2 * f + 1, l, 0).real()};
    for (int m = 1; m <= parts.lmax; ++m)
      for (int l = m; l <= parts.lmax; ++l) {
        const std::complex<double> g = parts.at(2 * f, l, m), h = parts.at(2 * f + 1, l, m);
        coefficients.at(f, l, m) = g + i * h;
        coefficients.at(f, l, -m) = signed_conjugate(g - i * h, m);
      }
  }
  return coefficients;
}

std::vector<std::complex<double>> synthesise(SphereTransform& transform, const ComplexCoefficients& coefficients,
                                             Monitor& monitor) {
  if (coefficients.lmax != transform.lmax() || coefficients.fields < 0 ||
      coefficients.values.size() != std::size_t(coefficients.fields) * ComplexCoefficients::count(coefficients.lmax))
    throw Error(Fault::bad_argument,
                fmt::format("{} complex fields of degree {} in {} coefficients for a transform of degree {}",
                            coefficients.fields, coefficients.lmax, coefficients.values.size(), transform.lmax()));
  const SphereCoefficients parts = split(coefficients);
  const std::size_t points = transform.grid().points(), count = SphereCoefficients::count(parts.lmax);
  std::vector<std::complex<double>> values(std::size_t(coefficients.fields) * points);
  for (int first = 0; first < coefficients.fields; first += batch) {
    const auto n = std::size_t(std::min(batch, coefficients.fields - first));
    std::vector<double> both(2 * n * points);
    transform.synthesise(int(2 * n), std::span(parts.values).subspan(2 * std::size_t(first) * count, 2 * n * count),
                         both, monitor);
    for (std::size_t f = 0; f < n; ++f)
      for (std::size_t i = 0; i < points; ++i)
        values[(std::size_t(first) + f) * points + i] = {both[2 * f * points + i], both[(2 * f + 1) * points + i]};
  }
  return values;
}

ComplexCoefficients analyse(SphereTransform& transform, const std::vector<std::complex<double>>& values,
                            Monitor& monitor) {
  const std::size_t points = transform.grid().points(), count = SphereCoefficients::count(transform.lmax());
  if (values.size() % points)
    throw Error(Fault::bad_argument,
                fmt::format("{} values are not a whole number of fields on {} points", values.size(), points));
  const int fields = int(values.size() / points);
  SphereCoefficients parts(transform.lmax(), 2 * fields);
  for (int first = 0; first < fields; first += batch) {
    const auto n = std::size_t(std::min(batch, fields - first));
    std::vector<double> both(2 * n * points);
    for (std::size_t f = 0; f < n; ++f)
      for (std::size_t i = 0; i < points; ++i) {
        const std::complex<double> value = values[(std::size_t(first) + f) * points + i];
        both[2 * f * points + i] = value.real();
        both[(2 * f + 1) * points + i] = value.imag();
      }
    transform.analyse(int(2 * n), both, std::span(parts.values).subspan(2 * std::size_t(first) * count, 2 * n * count),
                      monitor);
  }
  return join(parts);
}

} // namespace cowgpu
