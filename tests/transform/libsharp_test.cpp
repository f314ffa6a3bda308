#include "host/backend.hpp"
#include "tests/support/libsharp.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <random>
#include <vector>

using namespace cowgpu;

namespace {

using Complex = std::complex<double>;

// As much power in every degree.
std::vector<Complex> random_coefficients(int lmax, int first_order) {
  SphereCoefficients a(lmax, 1);
  std::mt19937_64 generator{unsigned(lmax)};
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int m = first_order; m <= lmax; ++m)
    for (int l = m; l <= lmax; ++l) {
      const double re = uniform(generator), im = uniform(generator), scale = 1 / std::sqrt(2 * l + 1);
      a.at(0, l, m) = {scale * re, m == 0 ? 0 : scale * im};
    }
  return a.values;
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double v : values) most = std::max(most, std::fabs(v));
  return most;
}

// Largest difference on the first and last ring, and on the others.
struct Differences {
  double polar = 0, other = 0;
};
Differences differences(const SphereGrid& grid, const std::vector<double>& a, const std::vector<double>& b) {
  Differences result;
  const std::size_t n = std::size_t(grid.ring_length), last = grid.points() - n;
  for (std::size_t i = 0; i < a.size(); ++i) {
    double& worst = i < n || i >= last ? result.polar : result.other;
    const double difference = std::fabs(a[i] - b[i]);
    if (!(difference <= worst)) worst = difference;
  }
  return result;
}

} // namespace

// libsharp rounds x = cos theta to double, which near the poles costs lmax^2 roundings at m = 0.
TEST_CASE("synthesis on the CPU agrees with libsharp", "[libsharp]") {
  const auto backend = make_cpu_backend();
  Monitor monitor;
  for (const GridKind kind : {GridKind::gauss_legendre, GridKind::clenshaw_curtis, GridKind::driscoll_healy})
    for (const int lmax : {1, 7, 100, 512}) {
      const SphereGrid grid = make_grid(kind, lmax);
      const auto transform = backend->sphere_transform(grid, lmax);
      const support::Libsharp libsharp(grid, lmax);
      for (const int first_order : {0, 1}) {
        const auto coefficients = random_coefficients(lmax, first_order);
        std::vector<double> ours(grid.points()), theirs(grid.points());
        transform->synthesise(1, coefficients, ours, monitor);
        libsharp.synthesise(coefficients.data(), theirs.data());
        const Differences d = differences(grid, ours, theirs);
        const double scale = largest(theirs);
        INFO(name(kind) << ", lmax " << lmax << ", from order " << first_order << ": " << d.polar / scale << " and "
                        << d.other / scale);
        CHECK(d.other <= 1e-12 * scale);
        CHECK(d.polar <= (first_order == 0 ? 1e-10 : 1e-12) * scale);
      }
    }
}

TEST_CASE("analysis on the CPU agrees with libsharp", "[libsharp]") {
  const auto backend = make_cpu_backend();
  Monitor monitor;
  for (const GridKind kind : {GridKind::gauss_legendre, GridKind::clenshaw_curtis, GridKind::driscoll_healy})
    for (const int lmax : {1, 7, 100, 512}) {
      const SphereGrid grid = make_grid(kind, lmax);
      const auto transform = backend->sphere_transform(grid, lmax);
      const support::Libsharp libsharp(grid, lmax);
      const auto truth = random_coefficients(lmax, 0);
      std::vector<double> values(grid.points());
      transform->synthesise(1, truth, values, monitor);
      std::vector<Complex> ours(truth.size()), theirs(truth.size());
      transform->analyse(1, values, ours, monitor);
      libsharp.analyse(values.data(), theirs.data());
      double worst = 0, most = 0;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        worst = std::max(worst, std::abs(ours[i] - theirs[i]));
        most = std::max(most, std::abs(theirs[i]));
      }
      INFO(name(kind) << ", lmax " << lmax << ": " << worst / most);
      CHECK(worst <= 1e-12 * most);
    }
}
