#include "tests/support/compare_potential.hpp"

#include "host/plan/potential.hpp"
#include "host/reference/potential.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

namespace cowgpu::test {
namespace {

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

} // namespace

Multipoles point_moments(const std::vector<PointMass>& masses, int lmax, double radius) {
  Multipoles q(lmax);
  q.reference_radius = radius;
  for (int l = 0; l <= lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      std::complex<long double> sum = 0;
      for (const PointMass& p : masses) {
        const long double r = p.at.cast<long double>().norm();
        const long double theta = r > 0 ? std::acos((long double)(p.at.z()) / r) : 0;
        sum += std::pow(r / radius, (long double)(l)) * p.mass *
               std::polar(std::sph_legendrel(unsigned(l), unsigned(m), theta),
                          m * std::atan2((long double)(p.at.y()), (long double)(p.at.x())));
      }
      q(l, m) = std::complex<double>(sum);
    }
  return q;
}

Multipoles random_moments(int lmax, double radius, unsigned seed) {
  Multipoles q(lmax);
  q.reference_radius = radius;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int l = 0; l <= lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      const double re = uniform(random), im = uniform(random);
      q(l, m) = {re, m == 0 ? 0 : im};
    }
  return q;
}

std::vector<Vec3> points_outside(std::size_t count, double radius, double farthest, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1), stretch(0, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 direction(uniform(random), uniform(random), uniform(random));
    if (i % 5 == 0) direction = Vec3::UnitZ() * (i % 2 ? 1 : -1);
    if (i % 5 == 1) direction.z() = 0;
    if (i % 5 == 2) direction.head<2>() *= std::pow(10.0, -8 * stretch(random)); // next to the axis
    const double far = i % 3 == 0 ? 1 : std::pow(farthest, stretch(random));
    points.emplace_back(direction.normalized() * (radius * far));
  }
  return points;
}

PotentialField potential(Backend& backend, const PotentialProblem& problem, RunReport* report) {
  Monitor silent;
  return backend.potential(problem, silent, report);
}

std::array<double, 3> potential_scale(const PotentialProblem& problem, const Vec3& at) {
  const plan::PotentialSeries series = plan::potential_series(problem);
  const double radius = problem.moments.reference_radius;
  std::array<double, 3> scale{};
  for (std::size_t d = 0; d < 3; ++d) {
    double sum = 0, power = 1;
    for (std::size_t l = 0; l < series.bounds[d].size(); ++l) {
      sum += std::pow(series.bounds[d][l] * power, 2) / double(2 * l + 1);
      power *= radius / at.norm();
    }
    scale[d] = std::sqrt(sum) / at.norm() / std::pow(radius, double(d));
  }
  return scale;
}

void compare_potential(Paths& paths, const PotentialProblem& problem, double figure) {
  const reference::ExteriorPotential<long double> reference(problem.moments, problem.lmax);
  const std::size_t count = problem.points.size(), step = count / 64 + 1;
  std::vector<reference::PotentialAt<long double>> truth;
  std::vector<std::array<double, 3>> scales;
  for (std::size_t i = 0; i < count; i += step) {
    truth.push_back(reference(problem.points[i].cast<long double>()));
    scales.push_back(potential_scale(problem, problem.points[i]));
  }
  const bool with_gradient = problem.derivatives != Derivatives::none,
             with_hessian = problem.derivatives == Derivatives::second;
  paths.each([&](Backend& backend) {
    const PotentialField field = potential(backend, problem);
    REQUIRE(field.value.size() == count);
    REQUIRE(field.gradient.size() == (with_gradient ? count : 0));
    REQUIRE(field.hessian.size() == (with_hessian ? count : 0));
    std::array<double, 3> worst{};
    const auto note = [&](std::size_t d, std::size_t t, long double difference) {
      const double error = double(std::fabs(difference)) / scales[t][d];
      if (!(error <= worst[d])) worst[d] = error;
    };
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const std::size_t i = t * step;
      note(0, t, field.value[i] - truth[t].value);
      if (with_gradient)
        for (int c = 0; c < 3; ++c) note(1, t, field.gradient[i][c] - truth[t].gradient[c]);
      if (!with_hessian) continue;
      for (Eigen::Index a = 0, k = 0; a < 3; ++a)
        for (Eigen::Index b = a; b < 3; ++b, ++k) note(2, t, field.hessian[i][std::size_t(k)] - truth[t].hessian(a, b));
    }
    for (std::size_t d = 0; d < 3; ++d)
      check_at_most(worst[d], figure,
                    fmt::format("{}, {} points, lmax {}, derivative {}", backend.facts().type, count, problem.lmax, d));
  });
}

bool same_bits(const PotentialField& a, const PotentialField& b) {
  return same(a.value, b.value) && same(a.gradient, b.gradient) && same(a.hessian, b.hessian);
}

} // namespace cowgpu::test
