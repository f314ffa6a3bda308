// Complex fields through the transforms of two real ones.
#include "host/error.hpp"
#include "host/reference/sphere_transform.hpp"
#include "host/spectrum/complex_fields.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/compare_transforms.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

using Complex = std::complex<double>;
constexpr int single_lmax = 6, random_lmax = 257;

ComplexCoefficients random_complex(int lmax, int fields) {
  std::mt19937_64 random(21);
  std::normal_distribution<double> normal;
  ComplexCoefficients c(lmax, fields);
  for (Complex& value : c.values) {
    const double re = normal(random);
    value = {re, normal(random)};
  }
  return c;
}

} // namespace

TEST_CASE("a single Y_lm of either sign of m is its values and comes back alone", "[complex_fields]") {
  const auto backend = make_cpu_backend();
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, single_lmax);
  const auto transform = backend->sphere_transform(grid, single_lmax);
  Monitor silent;
  double worst_value = 0, worst_back = 0;
  for (int l = 0; l <= single_lmax; ++l)
    for (int m = -l; m <= l; ++m) {
      ComplexCoefficients c(single_lmax, 1);
      const Complex factor(0.6, -0.8);
      c.at(0, l, m) = factor;
      const auto values = synthesise(*transform, c, silent);
      std::vector<Complex> expected(grid.points());
      for (int i = 0; i < grid.rings; ++i)
        for (int j = 0; j < grid.ring_length; ++j) {
          const auto ring = std::size_t(i);
          const long double p = reference::legendre_column<long double>(grid.cosine[ring], grid.sine[ring], std::abs(m),
                                                                        l)[std::size_t(l - std::abs(m))];
          const double sign = m < 0 && m % 2 ? -1 : 1; // P_l,-m = (-1)^m P_lm
          expected[ring * std::size_t(grid.ring_length) + std::size_t(j)] =
              factor * sign * double(p) * std::polar(1.0, m * grid.phi(j));
        }
      worst_value = std::max(worst_value, relative_error(values, expected));
      worst_back = std::max(worst_back, relative_error(analyse(*transform, values, silent).values, c.values));
    }
  check_at_most(worst_value, 1e-14, "values");
  check_at_most(worst_back, 1e-14, "coefficients");
}

TEST_CASE("complex fields come back from a grid on both paths", "[complex_fields][paths]") {
  Paths paths;
  paths.each([](Backend& backend) {
    const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, random_lmax);
    const auto transform = backend.sphere_transform(grid, random_lmax);
    Monitor silent;
    const ComplexCoefficients c = random_complex(random_lmax, 2);
    const auto back = analyse(*transform, synthesise(*transform, c, silent), silent);
    CHECK(back.lmax == random_lmax);
    CHECK(back.fields == 2);
    check_at_most(relative_error(back.values, c.values), 5e-13, backend.facts().type);
  });
}

TEST_CASE("splitting into real and imaginary part can be undone", "[complex_fields]") {
  for (const int lmax : {0, 1, 2, 7, 31}) {
    const ComplexCoefficients c = random_complex(lmax, 3);
    const SphereCoefficients parts = split(c);
    REQUIRE(parts.fields == 6);
    for (int f = 0; f < 6; ++f)
      for (int l = 0; l <= lmax; ++l) CHECK(parts.at(f, l, 0).imag() == 0);
    check_at_most(relative_error(join(parts).values, c.values), 2e-15, fmt::format("lmax {}", lmax));
  }
  // A real field has no imaginary part: c_l,-m = (-1)^m conj(c_lm).
  ComplexCoefficients real = random_complex(9, 1);
  for (int l = 0; l <= 9; ++l) {
    real.at(0, l, 0) = real.at(0, l, 0).real();
    for (int m = 1; m <= l; ++m) real.at(0, l, -m) = (m % 2 ? -1.0 : 1.0) * std::conj(real.at(0, l, m));
  }
  const SphereCoefficients parts = split(real);
  for (int m = 0; m <= 9; ++m)
    for (int l = m; l <= 9; ++l) {
      CHECK(parts.at(0, l, m) == real.at(0, l, m));
      CHECK(parts.at(1, l, m) == Complex(0));
    }
}

TEST_CASE("more complex fields than a transform takes are done in parts", "[complex_fields]") {
  const int lmax = 2, fields = most_fields + 1;
  const auto backend = make_cpu_backend();
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, lmax);
  const auto transform = backend->sphere_transform(grid, lmax);
  Monitor silent;
  const ComplexCoefficients c = random_complex(lmax, fields);
  const auto values = synthesise(*transform, c, silent);
  CHECK(values.size() == std::size_t(fields) * grid.points());
  check_at_most(relative_error(analyse(*transform, values, silent).values, c.values), 1e-14, "coefficients");
}

TEST_CASE("complex fields of the wrong size are refused", "[complex_fields]") {
  const auto backend = make_cpu_backend();
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 3);
  const auto transform = backend->sphere_transform(grid, 3);
  Monitor silent;
  CHECK_THROWS_AS(synthesise(*transform, ComplexCoefficients(2, 1), silent), Error);
  ComplexCoefficients short_one(3, 1);
  short_one.values.pop_back();
  CHECK_THROWS_AS(synthesise(*transform, short_one, silent), Error);
  CHECK_THROWS_AS(analyse(*transform, std::vector<Complex>(grid.points() + 1), silent), Error);
  CHECK_THROWS_AS(join(SphereCoefficients(3, 3)), Error);
  CHECK(synthesise(*transform, ComplexCoefficients(3, 0), silent).empty());
  CHECK(analyse(*transform, {}, silent).fields == 0);
}
