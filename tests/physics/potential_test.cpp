#include "engine/kernels/potential.hpp"
#include "host/error.hpp"
#include "host/mesh/body.hpp"
#include "host/plan/potential.hpp"
#include "host/reference/potential.hpp"
#include "tests/support/compare_potential.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

using LongVec3 = Eigen::Matrix<long double, 3, 1>;
using LongMatrix = Eigen::Matrix<long double, 3, 3>;

const std::vector<PointMass> cluster = {{1.5, Vec3(0.3, -0.4, 0.2)},
                                        {0.5, Vec3(-0.5, 0.1, -0.3)},
                                        {-0.25, Vec3(0.1, 0.6, 0.4)},
                                        {2, Vec3(0, 0, -0.7)},
                                        {1, Vec3(0, 0, 0)}};

reference::PotentialAt<long double> of_points(const std::vector<PointMass>& masses, const Vec3& at) {
  reference::PotentialAt<long double> sum;
  for (const PointMass& p : masses) {
    const LongVec3 d = at.cast<long double>() - p.at.cast<long double>();
    const long double r = d.norm();
    sum.value += p.mass / r;
    sum.gradient -= p.mass / (r * r * r) * d;
    sum.hessian += p.mass / (r * r * r) * (3 / (r * r) * d * d.transpose() - LongMatrix::Identity());
  }
  return sum;
}

Fault fault_of(const std::function<void()>& call, const char* word) {
  try {
    call();
  } catch (const Error& error) {
    CHECK_THAT(error.what(), Catch::Contains(word));
    return error.fault();
  }
  FAIL("not refused");
  return Fault::check_failed;
}

} // namespace

TEST_CASE("the series of point masses is their potential, with its first and second derivatives", "[potential]") {
  constexpr int lmax = 100;
  const Multipoles q = point_moments(cluster, lmax, 0.8);
  const std::vector<Vec3> points = {{1.5, -0.3, 0.7}, {0, 0, 1.6}, {0, 0, -1.6}, {2, 0, 0}, {-30, 50, 20}};
  Paths paths;
  paths.each([&](Backend& backend) {
    const PotentialField field = potential(backend, {q, points, lmax});
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto truth = of_points(cluster, points[i]);
      const double r = points[i].norm();
      INFO(backend.facts().type << ", point " << i);
      check_at_most(double(std::fabs(field.value[i] - truth.value)) * r, 4e-15, "value");
      check_at_most(double((field.gradient[i].cast<long double>() - truth.gradient).norm()) * r * r, 1e-14, "gradient");
      const SymmetricTensor& h = field.hessian[i];
      LongMatrix hessian;
      hessian << h[0], h[1], h[2], h[1], h[3], h[4], h[2], h[4], h[5];
      check_at_most(double((hessian - truth.hessian).norm()) * r * r * r, 4e-14, "hessian");
    }
  });
}

TEST_CASE("the reference is the closed form of point masses but for the degrees left out", "[potential]") {
  constexpr double radius = 0.8;
  for (const int lmax : {0, 1, 2, 9, 20}) {
    const Multipoles q = point_moments(cluster, 30, radius);
    const reference::ExteriorPotential<long double> series(q, lmax);
    CHECK(series.lmax() == lmax);
    for (const Vec3& at : {Vec3(3, -2, 4), Vec3(0, 0, 5), Vec3(7, 0, 0)}) {
      const auto found = series(at.cast<long double>()), truth = of_points(cluster, at);
      // The masses' moduli add up to 5.25; degree l falls like (R/r)^l, its derivatives have factors l and l^2.
      const double ratio = radius / at.norm(), n = lmax + 2;
      const double bound = 5.25 / at.norm() * std::pow(ratio, lmax + 1) / (1 - ratio) + 4e-16;
      CHECK(std::fabs(double(found.value - truth.value)) <= bound);
      CHECK(double((found.gradient - truth.gradient).norm()) <= 2 * n * bound / at.norm());
      CHECK(double((found.hessian - truth.hessian).norm()) <= 4 * n * n * bound / at.squaredNorm());
    }
  }
}

TEST_CASE("the series of a rod is its logarithm, on the axis and beside it", "[potential]") {
  // Of length 2 h: Q_l0 = sqrt((2l+1)/4pi) M h^l/(l+1) for even l.
  constexpr double h = 0.5, mass = 3;
  constexpr int lmax = 60;
  Multipoles q(lmax);
  q.reference_radius = h;
  for (int l = 0; l <= lmax; l += 2) q(l, 0) = std::sqrt((2 * l + 1) / (4 * std::numbers::pi)) * mass / (l + 1);
  const std::vector<Vec3> points = {{0, 0, 1}, {0, 0, -1.5}, {0.8, 0.6, 0}, {1, -2, 0.5}};
  Paths paths;
  paths.each([&](Backend& backend) {
    const PotentialField field = potential(backend, {q, points, lmax});
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& p = points[i];
      const double a = (p - Vec3(0, 0, h)).norm(), b = (p + Vec3(0, 0, h)).norm();
      const double truth = mass / (2 * h) * std::log((a + b + 2 * h) / (a + b - 2 * h));
      INFO(backend.facts().type << ", point " << i);
      check_at_most(std::abs(field.value[i] / truth - 1), std::pow(h / p.norm(), lmax + 1) + 2e-15, "value");
    }
    check_at_most(std::abs(field.gradient[0].z() + mass / (1 - h * h)), 4e-14, "on the axis"); // M / (z^2 - h^2)
    CHECK(std::abs(field.gradient[0].x()) + std::abs(field.gradient[0].y()) == 0);
  });
}

TEST_CASE("both paths sum what the reference sums, at any number of points and to any degree", "[potential]") {
  Paths paths;
  // Next to the axis errors grow like l^2.
  const std::vector<std::pair<int, double>> figures = {{0, 1e-14},  {1, 1e-14},  {2, 1e-14},
                                                       {20, 1e-13}, {80, 8e-13}, {512, 2.6e-11}};
  for (const auto& [lmax, figure] : figures) {
    const Multipoles q = random_moments(lmax, 1.3, unsigned(lmax));
    for (const std::size_t count : {0, 1, 7, 13, 1025}) {
      if (lmax == 512 && count == 7) continue;
      const std::vector<Vec3> points = points_outside(count, 1.3, 5, unsigned(count));
      compare_potential(paths, {q, points, lmax}, figure);
    }
  }
}

TEST_CASE("value and gradient alone are the same sums", "[potential]") {
  const Multipoles q = random_moments(31, 2, 1);
  const std::vector<Vec3> points = points_outside(77, 2, 3, 1);
  Paths paths;
  for (const Derivatives derivatives : {Derivatives::none, Derivatives::first})
    compare_potential(paths, {q, points, 20, derivatives}, 1e-13);
}

TEST_CASE("next to the axis no order that counts is lost up to the largest degree", "[potential]") {
  constexpr int lmax = largest_potential_degree;
  const Multipoles q = random_moments(lmax, 1, 3);
  std::vector<Vec3> points = {{0, 0, 1}};
  for (const double sine : {1e-3, 0.1, 0.3, 0.36788, 0.45, 0.9})
    points.emplace_back(0.6 * sine, -0.8 * sine, std::sqrt(1 - sine * sine));
  Paths paths;
  compare_potential(paths, {q, points, lmax, Derivatives::first}, 5e-11);
}

TEST_CASE("degrees left out far away change nothing that rounding does not", "[potential]") {
  const Multipoles q = random_moments(100, 1, 5);
  const std::vector<Vec3> points = points_outside(300, 1, 1e6, 2);
  Paths paths;
  paths.each([&](Backend& backend) {
    RunReport with, without;
    const PotentialField some = potential(backend, {q, points, 100}, &with),
                         all = potential(backend, {q, points, 100, Derivatives::second, 0}, &without);
    CHECK(with.elements < 0.8 * without.elements);
    double worst = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double scale = potential_scale({q, points, 100}, points[i])[0];
      worst = std::max(worst, std::abs(some.value[i] - all.value[i]) / scale);
    }
    check_at_most(worst, 1e-15, "left out");
  });
}

TEST_CASE("the second derivatives of a potential have no trace, and the potential of a ball is that of its mass",
          "[potential]") {
  Multipoles ball;
  ball.reference_radius = 2;
  ball.values = {7 / std::sqrt(4 * std::numbers::pi)};
  const std::vector<Vec3> points = points_outside(40, 2, 100, 7);
  Paths paths;
  paths.each([&](Backend& backend) {
    const PotentialField field = potential(backend, {ball, points, 0});
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double r = points[i].norm();
      CHECK(std::abs(field.value[i] * r / 7 - 1) < 2e-15);
      CHECK((field.gradient[i] * (r * r / 7) + points[i] / r).norm() < 4e-15);
      const SymmetricTensor& h = field.hessian[i];
      CHECK(std::abs(h[0] + h[3] + h[5]) * r * r * r / 7 < 4e-15);
      const Vec3 along(h[0] * points[i][0] + h[1] * points[i][1] + h[2] * points[i][2],
                       h[1] * points[i][0] + h[3] * points[i][1] + h[4] * points[i][2],
                       h[2] * points[i][0] + h[4] * points[i][1] + h[5] * points[i][2]);
      CHECK((along * (r * r / 14) - points[i] / r).norm() < 4e-15); // 2 M / r^3 along the radius
    }
  });
}

TEST_CASE("units of length only scale a potential, however large or small they are", "[potential]") {
  Paths paths;
  const std::vector<Vec3> points = points_outside(9, 1, 4, 3);
  const Multipoles q = random_moments(6, 1, 4);
  paths.each([&](Backend& backend) {
    const PotentialField here = potential(backend, {q, points, 6});
    for (const double unit : {0x1p-200, 0x1p200}) {
      Multipoles scaled = q;
      scaled.reference_radius = unit;
      std::vector<Vec3> there = points;
      for (Vec3& p : there) p *= unit;
      const PotentialField field = potential(backend, {scaled, there, 6});
      for (std::size_t i = 0; i < points.size(); ++i) {
        CHECK(field.value[i] * unit == Approx(here.value[i]).epsilon(1e-15));
        CHECK(field.hessian[i][1] * unit * unit * unit == Approx(here.hessian[i][1]).epsilon(1e-15));
      }
    }
  });
}

TEST_CASE("points inside, points that are none and degrees out of range are refused", "[potential]") {
  const Multipoles q = random_moments(4, 2, 1);
  Multipoles broken = q, flat = q;
  broken.values[7] = std::numeric_limits<double>::quiet_NaN();
  flat.reference_radius = 0;
  constexpr double inf = std::numeric_limits<double>::infinity();
  Paths paths;
  paths.each([&](Backend& backend) {
    const auto fault = [&](const Multipoles& moments, const Vec3& at, int lmax, const char* word) {
      const std::vector<Vec3> points = {Vec3(3, 0, 0), at};
      return fault_of([&] { potential(backend, {moments, points, lmax}); }, word);
    };
    CHECK(fault(q, Vec3(0, 1, 0), 4, "point 1 is 1 from the origin of the moments, 1 inside") == Fault::point_inside);
    CHECK(fault(q, Vec3::Zero(), 4, "point 1 is 0") == Fault::point_inside);
    CHECK(fault(q, Vec3(0, inf, 0), 4, "not finite") == Fault::bad_argument);
    CHECK(fault(q, Vec3(0, std::nan(""), 0), 4, "not finite") == Fault::bad_argument);
    CHECK(fault(q, Vec3(0, 1e160, 0), 4, "farther than 1e150 radii") == Fault::bad_argument);
    CHECK(fault(q, Vec3(0, 3, 0), 5, "degrees from 0 to 4") == Fault::bad_argument);
    CHECK(fault(q, Vec3(0, 3, 0), -1, "degrees from 0 to 4") == Fault::bad_argument);
    CHECK(fault(broken, Vec3(0, 3, 0), 4, "degree 3 and order 1") == Fault::bad_argument);
    CHECK(fault(flat, Vec3(0, 3, 0), 4, "above 0") == Fault::bad_argument);
  });
}

TEST_CASE("a potential stops when asked to, and says how far it is", "[potential]") {
  struct Impatient final : Monitor {
    bool stopped() const override { return true; }
  } impatient;
  struct Watching final : Monitor {
    void progress(const char*, double fraction) override {
      CHECK((fraction > 0 && fraction <= 1));
      last = fraction;
    }
    double last = 0;
  };
  const Multipoles q = random_moments(30, 1, 1);
  const std::vector<Vec3> points = points_outside(1000, 1, 2, 1);
  Paths paths;
  paths.each([&](Backend& backend) {
    CHECK(fault_of([&] { backend.potential({q, points, 30}, impatient); }, "") == Fault::interrupted);
    Watching watching;
    backend.potential({q, points, 30}, watching);
    CHECK(watching.last > 0);
  });
}

TEST_CASE("the same potential on the same device has the same bits", "[potential]") {
  const Multipoles q = random_moments(60, 1, 1);
  const std::vector<Vec3> points = points_outside(500, 1, 9, 1);
  Paths paths;
  paths.each([&](Backend& backend) {
    const PotentialField first = potential(backend, {q, points, 60});
    CHECK(same_bits(first, potential(backend, {q, points, 60})));
  });
}

TEST_CASE("a small budget of loop iterations takes more dispatches to the same bits", "[potential][vulkan]") {
  const auto usual = gpu_backend();
  if (!usual) return skip_without_gpu();
  GpuOptions options;
  options.iteration_budget = 150;
  const auto small = gpu_backend(options);
  const Multipoles q = random_moments(100, 1, 1);
  const std::vector<Vec3> points = points_outside(333, 1, 9, 1);
  RunReport few, many;
  CHECK(same_bits(potential(*usual, {q, points, 100}, &few), potential(*small, {q, points, 100}, &many)));
  REQUIRE((few.kernels.size() == 1 && many.kernels.size() == 1));
  CHECK(few.kernels[0].dispatches == 1);
  CHECK(many.kernels[0].dispatches > 35);
  CHECK(small->validation_messages() == std::vector<std::string>{});
  options.iteration_budget = 90;
  const auto none = gpu_backend(options);
  CHECK(fault_of([&] { potential(*none, {q, points, 100}); }, "loop iterations") == Fault::too_large);
}

TEST_CASE("several batches of points on Vulkan are as good as one", "[potential][vulkan]") {
  const auto gpu = gpu_backend();
  if (!gpu) return skip_without_gpu();
  const Multipoles q = random_moments(5, 1, 1);
  const std::vector<Vec3> points = points_outside(9000, 1, 2, 1);
  const PotentialField field = potential(*gpu, {q, points, 5}), truth = potential(*make_cpu_backend(), {q, points, 5});
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    worst = std::max(worst, std::abs(field.value[i] - truth.value[i]) / potential_scale({q, points, 5}, points[i])[0]);
  check_at_most(worst, 1e-14, "values");
  CHECK(gpu->validation_messages() == std::vector<std::string>{});
}

TEST_CASE("a potential that the device cuts short is an error, not an answer", "[potential][vulkan]") {
  if (!gpu_backend()) return skip_without_gpu();
  engine::Gpu gpu("auto", true);
  const Multipoles q = random_moments(400, 1, 1);
  const std::vector<Vec3> points(64, Vec3(0, 0, 1));
  const PotentialProblem problem{q, points, 400, Derivatives::none};
  const plan::PotentialSeries series = plan::potential_series(problem);
  // All orders in one dispatch: more iterations than software devices run.
  engine::Potential kernel(gpu.device(), {400, 1, series.table, 1U << 30});
  const std::vector<double> zeros(6 * 4);
  std::vector<double> sums(4);
  try {
    kernel.sum(zeros, std::vector<std::uint32_t>{400}, sums, {});
    CHECK(gpu.facts().type != "software");
  } catch (const engine::Error& error) {
    CHECK(error.failure() == engine::Failure::cut_short);
    CHECK_THAT(error.what(), Catch::Contains("ended a loop early"));
  }
  CHECK(gpu.validation_messages() == std::vector<std::string>{});
}
