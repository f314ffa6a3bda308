#include "host/error.hpp"
#include "host/physics/drop.hpp"
#include "host/physics/extrapolation.hpp"
#include "tests/support/point_masses.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace cowgpu;
using namespace cowgpu::physics;
using namespace cowgpu::test;

namespace {

using Real = long double;
constexpr double pi = std::numbers::pi;
const std::vector<Vec3> corners = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

DropProblem problem_of(const RigidBody& body, double height) {
  DropProblem problem;
  problem.body = body;
  problem.height = height;
  problem.vertices = corners;
  return problem;
}

LongMat3 about_z(Real angle) {
  return LongMat3(Eigen::AngleAxis<Real>(angle, LongVec3::UnitZ()));
}

} // namespace

TEST_CASE("extrapolation follows an ellipse of eccentricity 0.6 round and back to fourteen digits", "[drop]") {
  const Slope kepler = [](Real, const State& y) {
    const Real r = std::hypot(y[0], y[1]);
    State rate(4);
    rate << y[2], y[3], -y[0] / (r * r * r), -y[1] / (r * r * r);
    return rate;
  };
  State start(4);
  start << 0.4L, 0, 0, 2;
  Real step = 0;
  const Real period = 2 * std::numbers::pi_v<Real>;
  const State round = extrapolate(kepler, start, 0, period, {{{0, 1}}, {{2, 3}}}, step);
  CHECK(double((round - start).norm()) * 1e15 < 15);
  step = 0;
  const State back =
      extrapolate(kepler, extrapolate(kepler, start, 0, 2, {{{0, 1, 2, 3}}}, step), 2, 0, {{{0, 1, 2, 3}}}, step);
  CHECK(double((back - start).norm()) * 1e15 < 2.5);
  const Slope broken = [](Real t, const State& y) { return State(y * std::sqrt(1 - t)); };
  step = 0;
  CHECK_THROWS_AS(extrapolate(broken, start, 0, 2, {{{0, 1, 2, 3}}}, step), Error);
}

TEST_CASE("a point falls all the way in pi/2 sqrt(r^3/2gm), and near the ground in sqrt(2d/g)", "[drop]") {
  CHECK(double(radial_fall_time(2, 3, 3)) == Approx(pi / 2 * std::sqrt(27.0 / 4)).epsilon(1e-15));
  // 1 + 5/6 d/r at next order falls as r shrinks: g grows on the way.
  const double r = 6371e3, d = 1e-3, g = earth.gm / r / r;
  CHECK(double(radial_fall_time(earth.gm, r, d)) == Approx(std::sqrt(2 * d / g)).epsilon(1e-9));
}

TEST_CASE("a ball falls as a point does and does not turn at all", "[drop]") {
  const DropResult r = drop(problem_of(body_with({2, 2, 2}), 1000));
  CHECK(r.turn.norm() == 0);
  CHECK(r.torque.norm() == 0);
  CHECK(r.touching == 3);
  CHECK(r.as_low == 1);
  CHECK(double(r.fallen) == Approx(999).epsilon(1e-12));
  CHECK(double(r.time / r.kepler_time - 1) == Approx(0).margin(1e-16));
  CHECK(r.depth == Approx(1).epsilon(1e-12));
}

TEST_CASE("a body at 45 degrees turns by alpha t^2/2 (1 + k t^2/4), right to its twelfth digit", "[drop]") {
  for (const double height : {1.5, 12.0}) {
    DropProblem problem = problem_of(body_with({1, 1.4, 1.9}), height);
    problem.attitude = about_z(std::numbers::pi_v<Real> / 4);
    const DropResult r = drop(problem);
    const Real start = earth.radius + height, k = earth.gm / (start * start * start), t = r.time;
    const Real alpha = 1.5L * k * (1.4L - 1) / 1.9L;
    const Real expected = alpha * t * t / 2 * (1 + k * t * t / 4);
    CHECK(double(r.turn.norm() / expected - 1) == Approx(0).margin(double(k * k * t * t * t * t)));
    CHECK(double(r.first_order.norm() / (alpha * t * t / 2) - 1) == Approx(0).margin(1e-14));
    CHECK(double((r.turn - r.first_order).norm() / r.turn.norm()) < double(k * t * t));
    CHECK(double(r.turn.norm()) < 2e-6);
    // The axis of least inertia, x, turns towards the vertical: it stood at 45 degrees and rises.
    CHECK(double(r.turn.z()) > 0);
  }
}

TEST_CASE("the turn keeps its digits in a fall of a micrometre", "[drop]") {
  DropProblem problem = problem_of(body_with({1, 1.4, 1.9}), 1 / std::sqrt(2.0) + 1e-6);
  problem.attitude = about_z(std::numbers::pi_v<Real> / 4);
  const DropResult r = drop(problem);
  CHECK(double(r.fallen) < 2e-6);
  CHECK(double(r.turn.norm()) < 1e-12);
  CHECK(double((r.turn - r.first_order).norm() / r.first_order.norm()) < 1e-12);
}

TEST_CASE("energy and angular momentum are kept from any height, with a spin and without", "[drop]") {
  const std::vector<Point> tripod = centred({{3, {1, 0.2, 0}}, {1, {-0.4, 0.7, 0.3}}, {2, {0, -0.6, 0.1}}});
  for (const double height : {2.0, 20.0, 1e4, 1e6})
    for (const Vec3& spin : {Vec3(0, 0, 0), Vec3(0.01, -0.02, 0.005), Vec3(3, -1, 2)}) {
      if (spin.norm() > 1 && height > 20) continue;
      DropProblem problem = problem_of(body_of(tripod, 6), height);
      problem.spin = spin;
      problem.attitude = about_z(0.3L);
      const DropResult r = drop(problem);
      INFO(height << ", " << spin.transpose());
      CHECK(1e15 * double(r.energy_drift) < 0.04);
      CHECK(1e15 * double(r.momentum_drift) < 0.15);
      CHECK(double(r.time / r.kepler_time - 1) == Approx(0).margin(1e-12));
      CHECK(r.speed == Approx(std::sqrt(2 * earth.gm * double(r.fallen) / (earth.radius + height) /
                                        (earth.radius + height - double(r.fallen))))
                           .epsilon(1e-12));
    }
}

TEST_CASE("a body that spins about a principal axis has turned by omega t as it touches", "[drop]") {
  DropProblem problem = problem_of(body_with({1, 1.4, 1.9}), 7);
  problem.spin = Vec3(0, 0, 2);
  const DropResult r = drop(problem);
  const Real angle = std::atan2(r.attitude(1, 0), r.attitude(0, 0)),
             turns = std::remainder(2 * r.time - angle, 2 * Real(pi));
  CHECK(double(std::abs(turns)) == Approx(double(r.turn.norm())).epsilon(1e-6));
  CHECK(double(r.turn.norm()) < 1e-5);
  CHECK(double(r.turn.norm()) > 1e-9);
  // It touches at the height of the lowest corner of the turned octahedron, and not before.
  Real lowest = 7;
  for (const Vec3& corner : corners) {
    const LongVec3 p = LongVec3(0, earth.radius + 7 - r.fallen, 0) + r.attitude * corner.cast<Real>();
    lowest = std::min(lowest, p.norm() - earth.radius);
  }
  CHECK(double(lowest) == Approx(0).margin(4e-12));
}

TEST_CASE("a fast spin finds the first corner that touches, not a later one", "[drop]") {
  DropProblem problem = problem_of(body_with({1, 1.4, 1.9}), 1.2);
  problem.spin = Vec3(0, 0, 60);
  const DropResult r = drop(problem);
  // Dense times before the contact: no corner of the freely turning octahedron is under the ground.
  const Real g = earth.gm / (Real(earth.radius) * earth.radius);
  for (int k = 0; k < 100000; ++k) {
    const Real t = r.time * k / 100000;
    const Real angle = 60 * t, height = 1.2L - g * t * t / 2;
    const Real reach = std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
    if (!(height - reach > -1e-7L)) FAIL("at " << double(t) << " of " << double(r.time));
  }
}

TEST_CASE("a fall from the edge of the earth's Hill sphere takes the time of Kepler's", "[drop]") {
  DropProblem problem = problem_of(body_with({1, 1.4, 1.9}), 1.49e9);
  problem.attitude = about_z(0.3L);
  const DropResult r = drop(problem);
  CHECK(double(r.time / r.kepler_time - 1) == Approx(0).margin(1e-12));
  CHECK(double(r.energy_drift) < 1e-14);
}

TEST_CASE("a torque that is nothing but rounding leaves no momentum off, and a fast spin no energy", "[drop]") {
  const std::vector<Point> corners_of_box = [] {
    std::vector<Point> all;
    for (const double x : {-0.5, 0.5})
      for (const double y : {-1.0, 1.0})
        for (const double z : {-1.5, 1.5}) all.push_back({1, {x, y, z}});
    return all;
  }();
  DropProblem problem = problem_of(body_of(corners_of_box, 6), 10);
  problem.attitude = LongMat3(Eigen::AngleAxis<Real>(2 * std::numbers::pi_v<Real> / 3, LongVec3(1, 1, 1).normalized()));
  const DropResult still = drop(problem);
  CHECK(double(still.turn.norm()) < 1e-20);
  CHECK(1e15 * double(still.momentum_drift) < 0.15);
  problem.spin = Vec3(0, 0, 200);
  CHECK(1e15 * double(drop(problem).energy_drift) < 4);
}

TEST_CASE("a fall tells how far it is, and stops where it is told to", "[drop]") {
  struct Watch : Monitor {
    double last = 0;
    int calls = 0, most = 0;
    void progress(const char*, double fraction) override {
      if (!(fraction >= last && fraction <= 1)) FAIL(fraction << " after " << last);
      last = fraction;
      ++calls;
    }
    bool stopped() const override { return most > 0 && calls >= most; }
  };
  DropProblem problem = problem_of(body_with({1, 1.4, 1.9}), 1e5);
  problem.spin = Vec3(0, 3, 1);
  Watch watch;
  drop(problem, watch);
  CHECK(watch.last > 0.99);
  Watch stopping;
  stopping.most = watch.calls / 2;
  CHECK_THROWS_WITH(drop(problem, stopping), Catch::Contains("interrupted"));
  CHECK(stopping.calls == stopping.most);
}

TEST_CASE("a body that touches already, or has no surface, is refused", "[drop]") {
  const RigidBody body = body_with({1, 1.4, 1.9});
  CHECK_THROWS_AS(drop(problem_of(body, 1)), Error);
  CHECK_THROWS_AS(drop(problem_of(body, 0.5)), Error);
  CHECK_THROWS_AS(drop(problem_of(body, -3)), Error);
  CHECK_THROWS_WITH(drop(problem_of(body, 1e13)), Catch::Contains("lower --height"));
  CHECK_THROWS_WITH(drop(problem_of(body, 1.495e9)), Catch::Contains("Hill sphere"));
  DropProblem fast = problem_of(body, 2);
  fast.spin = Vec3(0, 0, 1e5);
  CHECK_THROWS_WITH(drop(fast), Catch::Contains("1000 times as fast"));
  DropProblem long_way = problem_of(body, 1e8);
  long_way.spin = Vec3(0, 0, 100);
  CHECK_THROWS_WITH(drop(long_way), Catch::Contains("turns are not followed"));
  CHECK_THROWS_AS(drop(problem_of(body, std::numeric_limits<double>::infinity())), Error);
  DropProblem empty = problem_of(body, 10);
  empty.vertices = {};
  CHECK_THROWS_AS(drop(empty), Error);
}
