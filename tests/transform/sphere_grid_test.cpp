#include "host/error.hpp"
#include "host/sphere_grid.hpp"
#include "tests/support/compare_moments.hpp"

#include <boost/multiprecision/float128.hpp>
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;
using Wide = boost::multiprecision::float128;

namespace {

const std::vector<GridKind> kinds = {GridKind::gauss_legendre, GridKind::clenshaw_curtis, GridKind::driscoll_healy,
                                     GridKind::driscoll_healy_square, GridKind::fejer};

double ulp(double x) {
  return std::nextafter(std::fabs(x), std::numeric_limits<double>::infinity()) - std::fabs(x);
}

struct WideNode {
  Wide cosine, weight;
};

// Newton's iteration for the zero of P_n next to `near`, in 113-bit arithmetic.
WideNode wide_node(int n, long double near) {
  Wide z = near, slope = 0;
  for (int pass = 0; pass < 4; ++pass) {
    Wide before = 0, value = 1;
    for (int k = 0; k < n; ++k) {
      const Wide next = ((2 * k + 1) * z * value - k * before) / (k + 1);
      before = value;
      value = next;
    }
    slope = n * (before - z * value) / (1 - z * z);
    if (pass < 3) z -= value / slope;
  }
  return {z, 2 / ((1 - z * z) * slope * slope)};
}

// sum over the rings of weight_i P_l(cos theta_i), for l = 0 ... degree.
std::vector<long double> ring_integrals(const SphereGrid& grid, int degree) {
  std::vector<long double> sums(std::size_t(degree) + 1, 0);
  for (std::size_t i = 0; i < grid.weights.size(); ++i) {
    long double before = 0, value = 1;
    for (int l = 0; l <= degree; ++l) {
      sums[std::size_t(l)] += grid.weights[i] * value;
      const long double next = ((2 * l + 1) * grid.cosine[i] * value - l * before) / (l + 1);
      before = value;
      value = next;
    }
  }
  return sums;
}

} // namespace

TEST_CASE("Gauss-Legendre nodes and weights are right to the last bits", "[grid]") {
  double worst_node = 0, worst_sine = 0, worst_weight = 0;
  for (const int n : {1, 2, 3, 4, 5, 8, 17, 64, 65, 257, 1024, 2049, 8193}) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, n - 1);
    REQUIRE(grid.rings == n);
    const int stride = n <= 257 ? 1 : n / 16;
    for (int i = 0; i < n; i += (i < 3 || i >= n - 3) ? 1 : std::min(stride, n - 3 - i)) {
      const auto at = std::size_t(i);
      const WideNode exact = wide_node(n, grid.cosine[at]);
      const Wide sine = sqrt((1 - exact.cosine) * (1 + exact.cosine));
      // In units of the last place of long double, and of double for the weight.
      const long double eps = std::numeric_limits<long double>::epsilon();
      worst_node = std::max(worst_node, double(abs(exact.cosine - Wide(grid.cosine[at])) / Wide(eps)));
      worst_sine = std::max(worst_sine, double(abs(sine - Wide(grid.sine[at])) / (Wide(eps) * sine)));
      worst_weight =
          std::max(worst_weight, double(abs(exact.weight - Wide(grid.weights[at])) / Wide(ulp(grid.weights[at]))));
      if (i > 0) CHECK(grid.theta[at] > grid.theta[at - 1]);
    }
  }
  check_at_most(worst_node, 2, "cosines, units of the last place of long double");
  check_at_most(worst_sine, 64, "sines, units of the last place of long double");
  check_at_most(worst_weight, 1, "weights, units of the last place of double");
}

TEST_CASE("the rings of every grid integrate polynomials of degree 2 lmax exactly, and Gauss-Legendre one more",
          "[grid]") {
  for (const GridKind kind : kinds)
    for (const int lmax : {0, 1, 2, 3, 7, 16, 31, 100, 257}) {
      INFO(name(kind) << " " << lmax);
      const SphereGrid grid = make_grid(kind, lmax);
      CHECK(grid.ring_length >= 2 * lmax + 1);
      const auto sums = ring_integrals(grid, 2 * lmax + (kind == GridKind::gauss_legendre ? 1 : 0));
      double worst = std::fabs(double(sums[0] - 2));
      for (std::size_t l = 1; l < sums.size(); ++l) worst = std::max(worst, std::fabs(double(sums[l])));
      check_at_most(worst, 5e-16, "integral of P_l over the rings");
      // and it is not exact for everything
      const auto beyond = ring_integrals(grid, 4 * lmax + 4);
      double most = 0;
      for (const long double s : std::span(beyond).subspan(1)) most = std::max(most, std::fabs(double(s)));
      CHECK(most > 1e-3);
    }
}

TEST_CASE("rings of the equiangular grids lie where their names say", "[grid]") {
  const SphereGrid cc = make_grid(GridKind::clenshaw_curtis, 90), dh = make_grid(GridKind::driscoll_healy, 89);
  CHECK(cc.rings == 181);
  CHECK(cc.latitude_degrees(0) == 90);
  CHECK(cc.latitude_degrees(90) == 0);
  CHECK(cc.latitude_degrees(180) == -90);
  CHECK(cc.latitude_degrees(60) == Approx(30).epsilon(1e-15));
  CHECK(dh.rings == 180);
  CHECK(dh.ring_length == 360);
  CHECK(dh.weights[0] == 0);
  CHECK(dh.latitude_degrees(1) == Approx(89).epsilon(1e-15));
  CHECK(dh.longitude_degrees(90) == 90);
  CHECK(dh.phi(90) == std::numbers::pi / 2);
  const SphereGrid dh1 = make_grid(GridKind::driscoll_healy_square, 89);
  CHECK(dh1.rings == 180);
  CHECK(dh1.ring_length == 180);
  CHECK(dh1.weights == dh.weights);
}

TEST_CASE("points of the f1 grid are the centres of cells, with Fejer's weights", "[grid]") {
  const SphereGrid f1 = make_grid(GridKind::fejer, 89);
  CHECK(f1.rings == 180);
  CHECK(f1.ring_length == 360);
  CHECK(f1.latitude_degrees(0) == 89.5);
  CHECK(f1.latitude_degrees(179) == -89.5);
  CHECK(f1.longitude_degrees(0) == 0.5);
  CHECK(f1.longitude_degrees(359) == 359.5);
  const SphereGrid two = make_grid(GridKind::fejer, 2, 4), three = make_grid(GridKind::fejer, 3, 6);
  CHECK(two.weights == std::vector<double>{1, 1});
  // n = 3: the interpolant through theta = 30, 90, 150 degrees integrates to (4 f_0 + 10 f_1 + 4 f_2) / 9.
  CHECK(three.weights[0] == Approx(4.0 / 9).epsilon(1e-15));
  CHECK(three.weights[1] == Approx(10.0 / 9).epsilon(1e-15));
  CHECK(three.weights[2] == three.weights[0]);
  for (const int n : {1, 4, 5, 50, 51}) // odd numbers of rings too: exact to degree n - 1
    for (const long double s : [&] {
           auto sums = ring_integrals(make_grid(GridKind::fejer, n, 2 * n), n - 1);
           sums[0] -= 2;
           return sums;
         }())
      CHECK(std::fabs(double(s)) < 5e-16);
}

TEST_CASE("rings are mirror images across the equator, bit for bit", "[grid]") {
  for (const GridKind kind : kinds)
    for (const int lmax : {1, 2, 9, 64, 301}) {
      const SphereGrid grid = make_grid(kind, lmax);
      const bool pole_alone = kind == GridKind::driscoll_healy || kind == GridKind::driscoll_healy_square;
      for (int i = pole_alone ? 1 : 0; i < grid.rings; ++i) {
        const auto at = std::size_t(i), mirror = std::size_t(pole_alone ? grid.rings - i : grid.rings - 1 - i);
        REQUIRE(grid.cosine[at] == -grid.cosine[mirror]);
        REQUIRE(grid.sine[at] == grid.sine[mirror]);
        REQUIRE(grid.weights[at] == grid.weights[mirror]);
      }
    }
}

TEST_CASE("a grid is known again by its shape", "[grid]") {
  for (const GridKind kind : kinds)
    for (const int lmax : {0, 1, 5, 64, 127}) {
      const SphereGrid grid = make_grid(kind, lmax), again = make_grid(kind, grid.rings, grid.ring_length);
      INFO(name(kind) << " " << lmax);
      CHECK(again.lmax == grid.lmax);
      CHECK(again.cosine == grid.cosine);
      CHECK(again.weights == grid.weights);
    }
  CHECK(make_grid(GridKind::gauss_legendre, 10, 7).lmax == 3);      // rings too short for degree 9
  CHECK(make_grid(GridKind::clenshaw_curtis, 181, 360).lmax == 90); // a map of one degree
  CHECK(make_grid(GridKind::fejer, 180, 360).lmax == 89);           // its cells
  CHECK(make_grid(GridKind::fejer, 7, 8).lmax == 3);
}

TEST_CASE("shapes that no grid has are refused", "[grid]") {
  const auto refused = [](GridKind kind, int rings, int ring_length) {
    try {
      make_grid(kind, rings, ring_length);
    } catch (const Error& error) {
      return error.fault() == Fault::bad_argument;
    }
    return false;
  };
  CHECK(refused(GridKind::driscoll_healy, 5, 10));
  CHECK(refused(GridKind::driscoll_healy, 6, 10));
  CHECK(refused(GridKind::driscoll_healy_square, 6, 12));
  CHECK(refused(GridKind::clenshaw_curtis, 1, 1));
  CHECK(refused(GridKind::gauss_legendre, 0, 1));
  CHECK(refused(GridKind::gauss_legendre, 5, 0));
  CHECK(refused(GridKind::gauss_legendre, -3, 8));
  CHECK(refused(GridKind::gauss_legendre, 2000000000, 8));
  CHECK_THROWS_AS(make_grid(GridKind::gauss_legendre, -1), Error);
  CHECK_THROWS_AS(make_grid(GridKind::gauss_legendre, largest_grid_degree + 1), Error);
}
