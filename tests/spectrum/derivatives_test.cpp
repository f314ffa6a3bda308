// Derivatives on grids, on both paths, against 80-bit sums: at every ring, the poles included.
#include "host/error.hpp"
#include "host/spectrum/derivatives.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/sphere_fields.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

const std::vector<int> degrees = {0, 1, 2, 7, 31};
constexpr int high_degree = 512; // of the one test that only looks at a few points

Direction point(const SphereGrid& grid, std::size_t i) {
  const auto ring = i / std::size_t(grid.ring_length);
  const long double step = 2 * std::numbers::pi_v<long double> / grid.ring_length;
  const long double phi = step * (static_cast<long double>(i % std::size_t(grid.ring_length)) + grid.shift);
  return {grid.cosine[ring], grid.sine[ring], double(phi), double(phi - double(phi))};
}

/// Both derivatives within `figure` of lmax times the field's scale on every `stride`-th point.
void check_derivatives(Backend& backend, GridKind kind, int grid_lmax, int lmax, int fields, std::size_t stride,
                       double figure) {
  const SphereGrid grid = make_grid(kind, grid_lmax);
  const auto transform = backend.sphere_transform(grid, lmax);
  const SphereCoefficients a = random_coefficients(lmax, fields, 1);
  std::vector<double> d_theta(std::size_t(fields) * grid.points()), d_phi(d_theta.size());
  Monitor silent;
  synthesise_derivatives(*transform, fields, a.values, d_theta, d_phi, silent);
  double worst_theta = 0, worst_phi = 0;
  for (int f = 0; f < fields; ++f)
    for (std::size_t i = 0; i < grid.points(); i += stride) {
      const FieldAt truth = field_at(a, f, point(grid, i));
      const double scale = field_scale(a, f) * std::max(1, lmax);
      const std::size_t k = std::size_t(f) * grid.points() + i;
      const double theta = std::fabs(double(truth.d_theta - d_theta[k])) / scale;
      const double phi = std::fabs(double(truth.d_phi - d_phi[k])) / scale;
      if (!(theta <= worst_theta)) worst_theta = theta;
      if (!(phi <= worst_phi)) worst_phi = phi;
    }
  const std::string what = fmt::format("{}, {} of degree {} for {}", backend.facts().type, name(kind), grid_lmax, lmax);
  check_at_most(worst_theta, figure, "d_theta, " + what);
  check_at_most(worst_phi, figure, "d_phi, " + what);
}

} // namespace

TEST_CASE("derivatives on a grid are the 80-bit sums at every point", "[derivatives][paths]") {
  Paths paths;
  paths.each([](Backend& backend) {
    for (const int lmax : degrees)
      for (const GridKind kind : {GridKind::gauss_legendre, GridKind::clenshaw_curtis, GridKind::driscoll_healy,
                                  GridKind::driscoll_healy_square, GridKind::fejer})
        check_derivatives(backend, kind, lmax, lmax, lmax < 20 ? 2 : 1, lmax < 20 ? 1 : 13, 2e-14);
    check_derivatives(backend, GridKind::driscoll_healy, 100, 100, 1, 97, 1e-13);
    check_derivatives(backend, GridKind::gauss_legendre, 9, 4, 1, 1, 2e-14);
  });
}

TEST_CASE("derivatives on a grid are the 80-bit sums at a higher degree", "[derivatives][paths]") {
  Paths paths;
  paths.each([](Backend& backend) {
    const std::size_t points = make_grid(GridKind::gauss_legendre, high_degree).points();
    check_derivatives(backend, GridKind::gauss_legendre, high_degree, high_degree, 1, points / 40 + 1, 1e-12);
    check_derivatives(backend, GridKind::clenshaw_curtis, high_degree, high_degree, 1, points / 40 + 1, 1e-12);
  });
}

TEST_CASE("on a pole d_phi is 0 and d_theta is the slope along each meridian", "[derivatives]") {
  // f = sin(theta) cos(phi) = x: towards the pole's horizon its slope is cos(phi) cos(theta).
  SphereCoefficients a(3, 1);
  a.at(0, 1, 1) = -std::sqrt(2 * std::numbers::pi / 3);
  const auto backend = make_cpu_backend();
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, 3);
  std::vector<double> d_theta(grid.points()), d_phi(grid.points());
  Monitor silent;
  synthesise_derivatives(*backend->sphere_transform(grid, 3), 1, a.values, d_theta, d_phi, silent);
  const auto last = std::size_t(grid.rings - 1) * std::size_t(grid.ring_length);
  for (int j = 0; j < grid.ring_length; ++j) {
    CHECK(d_theta[std::size_t(j)] == Approx(std::cos(grid.phi(j))).margin(1e-15));
    CHECK(d_theta[last + std::size_t(j)] == Approx(-std::cos(grid.phi(j))).margin(1e-15));
    CHECK(d_phi[std::size_t(j)] == 0);
    CHECK(d_phi[last + std::size_t(j)] == 0);
  }
}

TEST_CASE("tilts are rotations by a small angle", "[derivatives]") {
  // X and Y of x, y, z: turning z towards x, and z towards y.
  const double s = std::sqrt(4 * std::numbers::pi / 3);
  SphereCoefficients axes(1, 3);
  axes.at(0, 1, 1) = -s / std::sqrt(2);
  axes.at(1, 1, 1) = std::complex<double>(0, s / std::sqrt(2));
  axes.at(2, 1, 0) = s;
  const SphereCoefficients t = tilts(axes);
  REQUIRE(t.fields == 6);
  const auto is = [&](int f, int axis, double sign) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::complex<double> expected = axis < 0 ? 0.0 : sign * axes.field(axis)[i];
      CHECK(std::abs(t.field(f)[i] - expected) < 1e-15);
    }
  };
  is(0, 2, 1);  // X of x is z: a point turning from z towards x gains x at the rate z
  is(1, -1, 0); // Y of x
  is(2, -1, 0); // X of y
  is(3, 2, 1);  // Y of y is z
  is(4, 0, -1); // X of z is -x
  is(5, 1, -1); // Y of z is -y
}

TEST_CASE("derivatives take more fields than a transform, and either one alone", "[derivatives]") {
  const int lmax = 3, fields = most_fields + 5;
  const auto backend = make_cpu_backend();
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, lmax);
  const auto transform = backend->sphere_transform(grid, lmax);
  const SphereCoefficients a = random_coefficients(lmax, fields, 8);
  std::vector<double> d_theta(std::size_t(fields) * grid.points()), d_phi(d_theta.size()), alone(d_theta.size());
  Monitor silent;
  synthesise_derivatives(*transform, fields, a.values, d_theta, d_phi, silent);
  synthesise_derivatives(*transform, fields, a.values, alone, {}, silent);
  CHECK(alone == d_theta);
  synthesise_derivatives(*transform, fields, a.values, {}, alone, silent);
  CHECK(alone == d_phi);
  std::vector<double> one(grid.points());
  for (int f = 0; f < fields; ++f) {
    synthesise_derivatives(*transform, 1, a.field(f), one, {}, silent);
    CHECK(std::equal(one.begin(), one.end(), d_theta.begin() + std::ptrdiff_t(std::size_t(f) * grid.points())));
  }
  const auto call = [&](int n, std::size_t values) {
    synthesise_derivatives(*transform, n, a.values, std::span(alone).first(values), {}, silent);
  };
  CHECK_THROWS_AS(call(fields, alone.size() - 1), Error);
  CHECK_THROWS_AS(call(fields - 1, alone.size()), Error);
  CHECK_THROWS_AS(call(-1, alone.size()), Error);
}
