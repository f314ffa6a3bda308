#include "tests/support/compare_transforms.hpp"

#include "host/reference/sphere_transform.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "tests/support/compare_moments.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

namespace cowgpu::test {
namespace {

// The library's own distributions differ between standard libraries; this one does not.
double uniform(std::mt19937& engine) {
  return double(engine()) / 4294967296.0 - 0.5;
}

template <class T>
double largest_error(std::span<const T> a, std::span<const T> b) {
  if (a.size() != b.size()) return INFINITY;
  double error = 0, scale = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double apart = std::abs(a[i] - b[i]);
    if (!(apart <= error)) error = apart; // keeps a NaN
    if (std::isnan(error)) return INFINITY;
    scale = std::max(scale, std::abs(b[i]));
  }
  return scale > 0 ? error / scale : error;
}

} // namespace

std::vector<double> random_values(std::size_t size, std::uint32_t seed) {
  std::mt19937 engine(seed);
  std::vector<double> values(size);
  for (double& v : values) v = uniform(engine);
  return values;
}

std::vector<double> synthesise(SphereTransform& transform, const SphereCoefficients& coefficients) {
  Monitor silent;
  std::vector<double> values(std::size_t(coefficients.fields) * transform.grid().points(), NAN);
  transform.synthesise(coefficients.fields, coefficients.values, values, silent);
  return values;
}

std::vector<double> analyse_adjoint(SphereTransform& transform, const SphereCoefficients& coefficients) {
  Monitor silent;
  std::vector<double> values(std::size_t(coefficients.fields) * transform.grid().points(), NAN);
  transform.analyse_adjoint(coefficients.fields, coefficients.values, values, silent);
  return values;
}

SphereCoefficients analyse(SphereTransform& transform, int fields, std::span<const double> values) {
  Monitor silent;
  SphereCoefficients a(transform.lmax(), fields);
  std::fill(a.values.begin(), a.values.end(), std::complex<double>(NAN, NAN));
  transform.analyse(fields, values, a.values, silent);
  return a;
}

SphereCoefficients synthesise_adjoint(SphereTransform& transform, int fields, std::span<const double> values) {
  Monitor silent;
  SphereCoefficients a(transform.lmax(), fields);
  std::fill(a.values.begin(), a.values.end(), std::complex<double>(NAN, NAN));
  transform.synthesise_adjoint(fields, values, a.values, silent);
  return a;
}

double relative_error(std::span<const double> a, std::span<const double> b) {
  return largest_error<double>(a, b);
}
double relative_error(std::span<const std::complex<double>> a, std::span<const std::complex<double>> b) {
  return largest_error<std::complex<double>>(a, b);
}

void compare_transform(Backend& backend, const SphereGrid& grid, int lmax, int fields, double figure) {
  INFO(name(grid.kind) << " grid of " << grid.rings << " rings of " << grid.ring_length << ", lmax " << lmax << ", "
                       << fields << " fields, " << backend.facts().name);
  const auto transform = backend.sphere_transform(grid, lmax);
  const SphereCoefficients a = random_coefficients(lmax, fields, 1);
  const std::vector<double> g = random_values(std::size_t(fields) * grid.points());
  const auto s = synthesise(*transform, a), wa = analyse_adjoint(*transform, a);
  const auto b = analyse(*transform, fields, g), c = synthesise_adjoint(*transform, fields, g);

  const std::size_t count = SphereCoefficients::count(lmax), points = grid.points();
  for (std::size_t f = 0; f < std::size_t(fields); ++f) {
    INFO("field " << f);
    std::vector<reference::Pair<long double>> a_wide(count);
    for (std::size_t i = 0; i < count; ++i)
      a_wide[i] = {a.values[f * count + i].real(), a.values[f * count + i].imag()};
    std::vector<long double> g_wide(g.begin() + std::ptrdiff_t(f * points),
                                    g.begin() + std::ptrdiff_t((f + 1) * points));
    for (const bool weighted : {false, true}) {
      const auto wide = reference::synthesise<long double>(grid, lmax, a_wide, weighted);
      const std::vector<double> exact(wide.begin(), wide.end());
      const auto found = std::span(weighted ? wa : s).subspan(f * points, points);
      check_at_most(relative_error(found, exact), figure, weighted ? "adjoint of analysis" : "synthesis");

      const auto pairs = reference::analyse<long double>(grid, lmax, g_wide, weighted);
      std::vector<std::complex<double>> exact_a(count);
      for (std::size_t i = 0; i < count; ++i) exact_a[i] = {double(pairs[i].re), double(pairs[i].im)};
      const auto found_a = weighted ? b.field(int(f)) : c.field(int(f));
      check_at_most(relative_error(found_a, exact_a), figure, weighted ? "analysis" : "adjoint of synthesis");
    }
  }
}

} // namespace cowgpu::test
