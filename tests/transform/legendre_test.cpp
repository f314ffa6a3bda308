// The recurrence both paths run (host/plan/legendre.hpp), on its own.
#include "host/plan/legendre.hpp"
#include "host/reference/sphere_transform.hpp"
#include "tests/support/compare_moments.hpp"

#include <boost/multiprecision/float128.hpp>
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

struct Column {
  std::vector<double> values; // P_lm, l = m ... lmax; 0 before the start
  int first = 0;              // degree from which on they were computed
};

// P_lm on one ring of the northern half, in double precision, from the ring's seeds on.
Column column(const plan::Legendre& plan, const plan::Seeds& seeds, int m, int pair) {
  Column out;
  out.values.assign(std::size_t(plan.lmax - m) + 1, 0.0);
  out.first = plan.lmax + 1;
  const int block = pair / plan::block_pairs;
  const auto lane = std::size_t(pair % plan::block_pairs);
  const std::uint32_t start =
      seeds.start[std::size_t(m / seeds.orders) * std::size_t(plan.blocks) + std::size_t(block)];
  if (start == plan::Seeds::never) return out;
  const double* seed =
      &seeds.values[(std::size_t(m) * std::size_t(plan.blocks) + std::size_t(block)) * 2 * plan::block_pairs];
  double before = seed[lane], current = seed[plan::block_pairs + lane];
  const std::size_t at = plan.offset[std::size_t(m)];
  const double* e = &plan.e[plan.e_offset[std::size_t(m)]];
  const auto pair_at = std::size_t(pair);
  const std::size_t first = std::size_t(start) * std::size_t(seeds.segment);
  out.first = m + int(2 * first);
  for (std::size_t k = first; k < std::size_t(plan.steps(m)); ++k) {
    const double alpha = plan.alpha[at + k], older = k > 0 ? plan.alpha[at + k - 1] : 0;
    out.values[2 * k] = e[2 * k + 1] * alpha * current + e[2 * k] * older * before;
    if (2 * k + 1 < out.values.size()) out.values[2 * k + 1] = plan.x[pair_at] * alpha * current;
    const double b = block < plan.polar_blocks ? plan.b_polar[at + k] : plan.b[at + k];
    const double next = std::fma(std::fma(plan.a[at + k], plan.t[pair_at], b), current, before);
    before = current;
    current = next;
  }
  return out;
}

// Largest error of the recurrence over sqrt(l), over orders and rings. Low orders next to the pole, and the equator, stand
// apart: there the recurrence in x^2 has a double root, and every rounding grows linearly along it.
struct Worst {
  double anywhere = 0, at_double_root = 0, left_out = 0;
};
bool at_double_root(const plan::Legendre& plan, int m, int pair) {
  return (m <= 16 && pair < 16) || pair >= plan.pairs - 4;
}

Worst worst_errors(const SphereGrid& grid, int lmax, int orders, const std::vector<int>& ms,
                   const std::vector<int>& pairs) {
  const plan::Legendre plan = plan::legendre(grid, lmax);
  const plan::Seeds seeds = plan::seeds(plan, orders, orders == 1 ? 8 : 32);
  Worst worst;
  for (const int m : ms)
    for (const int pair : pairs) {
      const auto at = std::size_t(pair);
      const auto exact = reference::legendre_column<long double>(grid.cosine[at], grid.sine[at], m, lmax);
      const Column found = column(plan, seeds, m, pair);
      for (int l = m; l <= lmax; ++l) {
        const auto i = std::size_t(l - m);
        const double error = std::fabs(double(found.values[i] - exact[i]));
        if (l < found.first)
          worst.left_out = std::max(worst.left_out, error);
        else if (at_double_root(plan, m, pair))
          worst.at_double_root = std::max(worst.at_double_root, error / std::sqrt(l + 1.0));
        else
          worst.anywhere = std::max(worst.anywhere, error / std::sqrt(l + 1.0));
      }
    }
  return worst;
}

} // namespace

TEST_CASE("the reference's Legendre functions are right", "[legendre]") {
  using Wide = boost::multiprecision::float128;
  // Closed forms of degree 3, and 113-bit arithmetic at degree 300.
  const long double theta = 0.7L, x = std::cos(theta), s = std::sin(theta);
  constexpr long double pi = std::numbers::pi_v<long double>;
  const auto p = [&](int l, int m) { return reference::legendre_column<long double>(x, s, m, l).back(); };
  CHECK(double(p(0, 0)) == Approx(double(std::sqrt(1 / (4 * pi)))).epsilon(1e-15));
  CHECK(double(p(3, 0)) == Approx(double(std::sqrt(7 / (16 * pi)) * (5 * x * x * x - 3 * x))).epsilon(1e-15));
  CHECK(double(p(3, 1)) == Approx(double(-std::sqrt(21 / (64 * pi)) * s * (5 * x * x - 1))).epsilon(1e-15));
  CHECK(double(p(3, 2)) == Approx(double(std::sqrt(105 / (32 * pi)) * s * s * x)).epsilon(1e-15));
  CHECK(double(p(3, 3)) == Approx(double(-std::sqrt(35 / (64 * pi)) * s * s * s)).epsilon(1e-15));
  for (const int m : {0, 1, 17, 150, 300}) {
    const auto narrow = reference::legendre_column<long double>(x, s, m, 300);
    const Wide wide_x = x, wide_s = sqrt((1 - wide_x) * (1 + wide_x));
    const auto wide = reference::legendre_column<Wide>(wide_x, wide_s, m, 300);
    double worst = 0;
    for (std::size_t i = 0; i < wide.size(); ++i) worst = std::max(worst, std::fabs(double(wide[i] - Wide(narrow[i]))));
    check_at_most(worst, 1e-16, "80-bit against 113-bit arithmetic");
  }
}

TEST_CASE("the recurrence is right near the poles and the equator, and leaves out nothing above 1e-30", "[legendre]") {
  for (const GridKind kind : {GridKind::gauss_legendre, GridKind::clenshaw_curtis, GridKind::driscoll_healy})
    for (const int lmax : {0, 1, 2, 7, 31, 100, 257})
      for (const int orders : {1, 8}) {
        INFO(name(kind) << " " << lmax << " " << orders);
        const SphereGrid grid = make_grid(kind, lmax);
        std::vector<int> ms, pairs;
        for (int m = 0; m <= lmax; m += lmax < 40 ? 1 : 7) ms.push_back(m);
        for (int i = 0; i < (grid.rings + 1) / 2; i += lmax < 40 || i < 8 ? 1 : 5) pairs.push_back(i);
        const Worst worst = worst_errors(grid, lmax, orders, ms, pairs);
        check_at_most(worst.anywhere, 2e-14, "error over sqrt(l)");
        check_at_most(worst.at_double_root, 1e-13, "error over sqrt(l), next to the pole and on the equator");
        check_at_most(worst.left_out, 1e-30, "left out");
      }
}

TEST_CASE("the recurrence is right to degree 4096", "[legendre][long]") {
  const int lmax = 4096;
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, lmax);
  for (const int orders : {1, 8}) {
    const Worst worst = worst_errors(grid, lmax, orders, {0, 1, 2, 10, 100, 555, 1777, 3000, 4000, 4096},
                                     {0, 1, 2, 3, 8, 40, 200, 700, 1023, 1024, 1500, 2000, 2046, 2047, 2048});
    check_at_most(worst.anywhere, 1e-13, "error over sqrt(l)");
    check_at_most(worst.at_double_root, 6e-12, "error over sqrt(l), next to the pole and on the equator");
    check_at_most(worst.left_out, 1e-30, "left out");
  }
}

TEST_CASE("the addition theorem holds on the first, the middle and the last ring", "[legendre]") {
  for (const int lmax : {10, 200, 1024}) {
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, lmax);
    const plan::Legendre plan = plan::legendre(grid, lmax);
    const plan::Seeds seeds = plan::seeds(plan, 1, 8);
    for (const int pair : {1, plan.pairs / 2, plan.pairs - 1}) {
      std::vector<double> sums(std::size_t(lmax) + 1, 0.0);
      for (int m = 0; m <= lmax; ++m) {
        const Column p = column(plan, seeds, m, pair);
        for (int l = m; l <= lmax; ++l)
          sums[std::size_t(l)] += (m == 0 ? 1 : 2) * p.values[std::size_t(l - m)] * p.values[std::size_t(l - m)];
      }
      double worst = 0;
      for (int l = 0; l <= lmax; ++l)
        worst = std::max(worst, std::fabs(sums[std::size_t(l)] * 4 * std::numbers::pi / (2 * l + 1) - 1));
      check_at_most(worst, 1e-12, "sum of |Y_lm|^2 over (2l+1)/4pi, less 1");
    }
  }
}

TEST_CASE("no start value is denormal, not a number or infinite, to degree 8192", "[legendre][long]") {
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, largest_grid_degree);
  const plan::Legendre plan = plan::legendre(grid, largest_grid_degree);
  for (const auto* array : {&plan.a, &plan.b, &plan.b_polar, &plan.alpha, &plan.e, &plan.t}) {
    std::size_t odd = 0;
    for (const double v : *array) odd += v != 0 && !std::isnormal(v);
    CHECK(odd == 0);
  }
  const plan::Seeds seeds = plan::seeds(plan, 8, 32);
  std::size_t odd = 0;
  for (const double v : seeds.values) odd += v != 0 && !std::isnormal(v);
  CHECK(odd == 0);
}
