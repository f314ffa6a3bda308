// The benchmark cow: both paths against extended precision, and the numbers that rational arithmetic gives for it.
#include "host/mesh/geometry.hpp"
#include "host/plan/moments.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <complex>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

/// Both paths against the 80-bit reference, itself exact to 1e-22 of every degree's bound.
void compare_cow(int lmax, double figure) {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  Paths paths;
  paths.compare(moment_problem(cow->mesh(), lmax, centre_of_mass(*cow)), figure, 1e-22);
}

} // namespace

TEST_CASE("the benchmark cow has the moments that rational arithmetic gives", "[moments][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  CHECK(volume(*cow) == Approx(0.0534799266715660841).epsilon(1e-15));
  const Vec3 centre = centre_of_mass(*cow);
  const Vec3 expected_centre(-0.0909084661394062, 0.0449178604782050975, -0.0000825839046777753);
  check_at_most((centre - expected_centre).norm(), 1e-16, "centre of mass");

  struct Row {
    int l, m;
    std::complex<double> value; // raw, not conjugated
  };
  const Row rows[] = {
      {0, 0, 1.508640877850e-2},
      {2, 0, -8.101857470525e-4},
      {2, 2, {7.465215904540e-4, 2.191867934902e-4}},
      {3, 1, {8.763826364775e-5, 3.521091540804e-5}},
      {3, 3, {-7.067304396414e-5, -1.247715888377e-4}},
      {4, 0, 9.526146034096e-5},
      {4, 4, {2.995401618969e-5, 8.306764969088e-5}},
  };
  Paths paths;
  const MomentProblem problem = moment_problem(cow->mesh(), 4, centre);
  paths.each([&](Backend& backend) {
    const Multipoles q = moments(backend, problem);
    for (const Row& row : rows)
      check_at_most(std::abs(q(row.l, row.m) * std::pow(q.reference_radius, row.l) / row.value - 1.0), 8e-13,
                    fmt::format("Q_{},{}", row.l, row.m)); // 13 digits are printed
    // Cartesian quadrupole Q_ij = integral of 3 x_i x_j - r^2 delta_ij.
    const double square = std::pow(q.reference_radius, 2);
    const double zz = q(2, 0).real() * square * std::sqrt(16 * std::acos(-1) / 5);
    const double xx_minus_yy = q(2, 2).real() * square * std::sqrt(32 * std::acos(-1) / 15) * 3;
    const double xy = q(2, 2).imag() * square * std::sqrt(32 * std::acos(-1) / 15) * 1.5;
    check_at_most(std::abs(zz / -2.56882502993958448e-3 - 1), 2.2e-15, "Q_zz");
    check_at_most(std::abs(xx_minus_yy / (4.18334384358552252e-3 + 1.61451881364593804e-3) - 1), 2.2e-15,
                  "Q_xx - Q_yy");
    check_at_most(std::abs(xy / 8.5115751586127807e-4 - 1), 2.2e-15, "Q_xy");
  });
}

TEST_CASE("the benchmark cow to degree 64 agrees with extended precision", "[moments][benchmark]") {
  compare_cow(64, 3e-15);
}

TEST_CASE("the benchmark cow to degree 512 agrees with extended precision", "[moments][benchmark][long]") {
  compare_cow(512, 3e-14);
}

TEST_CASE("the benchmark cow to degree 2048 agrees with extended precision", "[moments][benchmark][long]") {
  compare_cow(2048, 1e-13);
}

TEST_CASE("a cut-off shrinks the work on the benchmark cow and bounds its error", "[moments][benchmark][cut-off]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  Paths paths;
  MomentProblem problem = moment_problem(cow->mesh(), 300, centre_of_mass(*cow));
  const auto bound = plan::degree_bound(problem);
  paths.each([&](Backend& backend) {
    problem.cut_off = 0;
    const Multipoles full = moments(backend, problem);
    double before = 1;
    for (const double cut_off : {default_cut_off, 1e-10, 1e-6}) {
      problem.cut_off = cut_off;
      RunReport report;
      const Multipoles q = moments(backend, problem, &report);
      CHECK(report.elements < 0.9 * before * report.full_elements);
      before = report.elements / report.full_elements;
      double worst = 0;
      for (int l = 0; l <= q.lmax; ++l)
        for (int m = 0; m <= l; ++m) worst = std::max(worst, std::abs(q(l, m) - full(l, m)) / bound[std::size_t(l)]);
      // Other sums are formed, so their rounding differs.
      check_at_most(worst, cut_off + 4e-16, fmt::format("cut-off {}", cut_off));
      if (cut_off == default_cut_off) {
        CHECK(before < 0.35);
        check_close(q, full, problem, 2.2e-15);
      }
    }
  });
}
