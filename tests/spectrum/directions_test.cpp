// Fields at arbitrary directions against 80-bit sums, from pole to pole.
#include "host/error.hpp"
#include "host/spectrum/directions.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/sphere_fields.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

constexpr double pi = std::numbers::pi;

DirectionValues at(const SphereCoefficients& a, const std::vector<Direction>& places, bool derivatives = true,
                   unsigned threads = 0) {
  Monitor silent;
  return DirectionSynthesis(a, derivatives, threads).at(places, silent);
}

/// The poles, places next to them, the equator, where the method changes, angles out of range, and `more` at random.
std::vector<Direction> places(int lmax, std::size_t more) {
  std::vector<Direction> all;
  for (const double theta : {0.0, pi, 1e-300, 1e-8, 1e-3, pi - 1e-5, 0.02, pi / 4, 0.75 * pi, pi / 2, -0.3, 4.0, 9.0})
    all.push_back(direction(theta, 0.7 + theta));
  for (const double edge : {15.9, 16.1}) // of the polar cap
    for (const bool south : {false, true}) {
      const double theta = std::asin(std::min(0.5, edge / std::max(1, lmax)));
      all.push_back(direction(south ? pi - theta : theta, edge));
    }
  for (const Vec3& r : {Vec3(0, 0, 3), Vec3(0, 0, -1e-200), Vec3(1e-12, 0, 1), Vec3(1, 0, 0), Vec3(-1e200, 1, 3)})
    all.push_back(direction(r));
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (std::size_t i = 0; i < more; ++i) all.push_back(direction(std::acos(unit(random)), 10 * unit(random)));
  return all;
}

/// Values within `figure` of the field's scale, derivatives of that times lmax, at every place.
void check_places(int lmax, int fields, const std::vector<Direction>& all, double figure) {
  const SphereCoefficients a = random_coefficients(lmax, fields, std::uint32_t(lmax));
  const DirectionValues result = at(a, all);
  REQUIRE(result.values.size() == all.size() * std::size_t(fields));
  REQUIRE(result.d_theta.size() == result.values.size());
  REQUIRE(result.d_phi.size() == result.values.size());
  double worst[3] = {};
  const auto take = [](double& most, double error) {
    if (!(error <= most)) most = error; // NaN stays
  };
  for (int f = 0; f < fields; ++f) {
    const double scale = field_scale(a, f), slope = scale * std::max(1, lmax);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const FieldAt truth = field_at(a, f, all[i]);
      const std::size_t k = std::size_t(f) * all.size() + i;
      take(worst[0], std::fabs(double(truth.value - result.values[k])) / scale);
      take(worst[1], std::fabs(double(truth.d_theta - result.d_theta[k])) / slope);
      take(worst[2], std::fabs(double(truth.d_phi - result.d_phi[k])) / slope);
    }
  }
  check_at_most(worst[0], figure, fmt::format("values at lmax {}", lmax));
  check_at_most(worst[1], figure, fmt::format("d_theta at lmax {}", lmax));
  check_at_most(worst[2], figure, fmt::format("d_phi at lmax {}", lmax));
}

} // namespace

TEST_CASE("fields and derivatives at directions are the 80-bit sums", "[directions]") {
  for (const int lmax : {0, 1, 2, 3, 7, 15, 16, 31, 100, 257})
    check_places(lmax, lmax < 50 ? 3 : 1, places(lmax, lmax < 50 ? 40 : 10), 2.5e-14 * std::sqrt(std::max(1, lmax)));
}

TEST_CASE("fields and derivatives at directions are the 80-bit sums at degree 1024", "[directions]") {
  check_places(1024, 1, places(1024, 2), 3e-12);
}

TEST_CASE("a spherical harmonic at directions is its closed form", "[directions]") {
  SphereCoefficients a(2, 1);
  a.at(0, 2, 1) = {0.5, 0}; // Re Y_21 = -sqrt(15/8pi) sin cos cos(phi)
  const double theta = 0.8, phi = 2.1, factor = -std::sqrt(15 / (8 * pi));
  const DirectionValues v = at(a, {direction(theta, phi)});
  CHECK(v.values[0] == Approx(factor * std::sin(theta) * std::cos(theta) * std::cos(phi)).epsilon(1e-14));
  CHECK(v.d_theta[0] == Approx(factor * std::cos(2 * theta) * std::cos(phi)).epsilon(1e-14));
  CHECK(v.d_phi[0] == Approx(-factor * std::sin(theta) * std::cos(theta) * std::sin(phi)).epsilon(1e-14));
}

TEST_CASE("at the poles d_phi is 0 and d_theta turns with the meridian", "[directions]") {
  const SphereCoefficients a = random_coefficients(30, 1, 1);
  std::vector<Direction> poles;
  for (const double z : {1.0, -1.0})
    for (const double phi : {0.0, pi / 2, pi, 1.0}) {
      poles.push_back(direction(Vec3(0, 0, z)));
      poles.back().phi = phi;
    }
  const DirectionValues v = at(a, poles);
  for (std::size_t i = 0; i < poles.size(); ++i) {
    CHECK(v.values[i] == v.values[i / 4 * 4]);
    CHECK(v.d_phi[i] == 0);
  }
  for (const std::size_t i : {0U, 4U}) {
    const double scale = 30 * field_scale(a);
    CHECK(std::fabs(v.d_theta[i + 2] + v.d_theta[i]) < 1e-15 * scale);
    CHECK(std::fabs(v.d_theta[i + 3] - std::cos(1) * v.d_theta[i] - std::sin(1) * v.d_theta[i + 1]) < 1e-15 * scale);
    CHECK(std::fabs(v.d_theta[i]) > 1e-3 * scale);
  }
}

TEST_CASE("a direction's values do not depend on other directions, threads or fields", "[directions]") {
  const SphereCoefficients a = random_coefficients(90, 3, 2);
  const std::vector<Direction> all = places(90, 500);
  const DirectionValues many = at(a, all, true, 1), others = at(a, all, true, 3);
  CHECK(many.values == others.values);
  CHECK(many.d_theta == others.d_theta);
  CHECK(many.d_phi == others.d_phi);
  CHECK(at(a, all, false).values == many.values);
  for (std::size_t i = 0; i < all.size(); i += 37) {
    const DirectionValues one = at(a, {all[i]});
    for (std::size_t f = 0; f < 3; ++f) {
      CHECK(one.values[f] == many.values[f * all.size() + i]);
      CHECK(one.d_theta[f] == many.d_theta[f * all.size() + i]);
    }
  }
}

TEST_CASE("angles and vectors name the same direction", "[directions]") {
  const Direction a = direction(2.0, -1.3);
  const Direction b = direction(Vec3(std::sin(2.0) * std::cos(-1.3), std::sin(2.0) * std::sin(-1.3), std::cos(2.0)));
  CHECK(std::fabs(double(a.cosine - b.cosine)) < 2e-16);
  CHECK(std::fabs(double(a.sine - b.sine)) < 2e-16);
  CHECK(std::fabs(b.phi - a.phi) < 3e-16);
  for (const double length : {1e-310, 1e308}) {
    const Direction c = direction(Vec3(0, length, 0));
    CHECK(c.cosine == 0);
    CHECK(c.sine == 1);
    CHECK(c.phi == pi / 2);
  }
}

TEST_CASE("no direction gives a NaN at degree 4096", "[directions][long]") {
  const SphereCoefficients a = random_coefficients(4096, 1, 3);
  const DirectionValues v = at(a, places(4096, 0));
  const double scale = field_scale(a);
  for (std::size_t i = 0; i < v.values.size(); ++i) {
    CHECK(std::fabs(v.values[i]) < 10 * scale);
    CHECK(std::fabs(v.d_theta[i]) < 1e5 * scale);
    CHECK(std::fabs(v.d_phi[i]) < 1e5 * scale);
  }
}

TEST_CASE("synthesis at directions takes none, tells its progress, stops when asked and refuses nonsense",
          "[directions]") {
  const SphereCoefficients a = random_coefficients(40, 1, 6);
  CHECK(at(a, {}).values.empty());
  CHECK(at(SphereCoefficients(5, 0), places(5, 0)).values.empty());

  struct Watch : Monitor {
    void progress(const char* what, double fraction) override {
      CHECK(std::string(what) == "synthesis at directions");
      CHECK((fraction >= last && fraction <= 1));
      last = fraction;
      if (++calls == stop_after) stop = true;
    }
    bool stopped() const override { return stop; }
    double last = 0;
    int calls = 0, stop_after = 0;
    std::atomic<bool> stop = false;
  };
  const DirectionSynthesis synthesis(a, false, 1);
  Watch watch;
  synthesis.at(places(40, 1000), watch);
  CHECK(watch.last == 1);
  Watch stopping;
  stopping.stop_after = 3;
  CHECK_THROWS_AS(synthesis.at(places(40, 1000), stopping), Error);
  CHECK(stopping.calls == 3);

  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(direction(nan, 0), Error);
  CHECK_THROWS_AS(direction(0, infinity), Error);
  CHECK_THROWS_AS(direction(Vec3(0, 0, 0)), Error);
  CHECK_THROWS_AS(direction(Vec3(0, nan, 1)), Error);
  CHECK_THROWS_AS(direction(Vec3(infinity, 0, 1)), Error);
}
