#include "host/error.hpp"
#include "host/physics/drop.hpp"
#include "host/physics/extrapolation.hpp"
#include "host/physics/tides.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/point_masses.hpp"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include <functional>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::physics;
using namespace cowgpu::test;

namespace {

using Real = long double;
constexpr double pi = std::numbers::pi;

const std::vector<Point> tripod = centred({{3, {1, 0.2, 0}}, {1, {-0.4, 0.7, 0.3}}, {2, {0, -0.6, 0.1}}});

PrincipalAxes axes_of(const Vec3& moments) {
  PrincipalAxes p;
  p.moments = moments;
  p.quadrupole = Vec3::Constant(moments.sum()) - 3 * moments;
  p.first_two_alike = moments[0] == moments[1];
  p.last_two_alike = moments[1] == moments[2];
  return p;
}

LongMat3 exponential(const LongVec3& turn) {
  const Real angle = turn.norm();
  return angle > 0 ? LongMat3(Eigen::AngleAxis<Real>(angle, turn / angle)) : LongMat3(LongMat3::Identity());
}

// The full equations of a rigid body on a circular orbit: attitude as (1 + w, v), angular velocity in the body's axes.
State moved(const RigidBody& body, const Orbit& orbit, const LongVec3& turn, const LongVec3& omega, Real time) {
  const LongMat3 inertia = body.inertia().cast<Real>(), inverse = inertia.inverse();
  const Eigen::Quaternion<Real> start(exponential(turn));
  State y(7);
  y << start.w() - 1, start.vec(), omega;
  const Slope slope = [&](Real t, const State& s) {
    const LongVec3 v = s.segment<3>(1), spin = s.segment<3>(4);
    const Real at = orbit.rate * t;
    const LongVec3 x = rotation_of(s[0], v).transpose() * (-orbit.radius * LongVec3(std::cos(at), std::sin(at), 0));
    State rate(7);
    rate << -v.dot(spin) / 2, ((1 + s[0]) * spin + v.cross(spin)) / 2,
        inverse * (pull(body, orbit.gm, x).torque - spin.cross(LongVec3(inertia * spin)));
    return rate;
  };
  Real step = time / 100;
  return extrapolate(slope, y, 0, time, {{{0, 1, 2, 3}, 1}, {{4, 5, 6}, Real(orbit.rate)}}, step, 1e-15L);
}

// Out of the orbit's frame, as a small rotation vector.
LongVec3 turned_by(const State& y, const Orbit& orbit, Real time) {
  const LongMat3 r = exponential(LongVec3(0, 0, -orbit.rate * time)) * rotation_of(y[0], y.segment<3>(1));
  return LongVec3(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1)) / 2;
}

Orbit low_orbit(const RigidBody& body) {
  return circular_orbit(earth, body, 7e6);
}

} // namespace

TEST_CASE("force, torque and energy of point masses are Newton's to all orders", "[tides]") {
  const RigidBody body = body_of(tripod, 40);
  const double mass = 6;
  for (const Vec3& direction : {Vec3(1, 2, 3), Vec3(-3, 0.1, 1), Vec3(0, 0, 5), Vec3(0, 4, 0)}) {
    const LongVec3 x = 6 * direction.normalized().cast<Real>();
    const Pull truth = newton(tripod, 5, x), found = pull(body, 5, x);
    const Real r = x.norm();
    const LongVec3 force = found.force + 5 * mass / (r * r * r) * x;
    CHECK(double((force - truth.force).norm() / truth.force.norm()) < 1e-15);
    CHECK(double((found.torque - truth.torque).norm() / truth.torque.norm()) < 1e-14);
    CHECK(double(found.energy - 5 * mass / r - truth.energy) ==
          Approx(0).margin(1e-15 * double(std::abs(truth.energy))));
    CHECK(double((force.cross(x) + found.torque).norm() / found.torque.norm()) < 1e-14); // action and reaction
  }
}

TEST_CASE("each degree brings the torque of a dumbbell nearer by (R/r)", "[tides]") {
  const std::vector<Point> dumbbell = centred({{2, {1, 0, 0}}, {1, {-1, 0, 0}}});
  const LongVec3 x(20, 15, 0); // R/r = 4/3 / 25
  const Pull truth = newton(dumbbell, 1, x);
  double before = 1;
  for (const int order : {2, 4, 6, 8}) {
    const double error =
        double((pull(body_of(dumbbell, order), 1, x).torque - truth.torque).norm() / truth.torque.norm());
    CHECK(error < (order == 2 ? 0.05 : before / 50));
    before = error;
  }
  CHECK(before < 5e-9); // (4/75)^7 = 1.2e-9
}

TEST_CASE("the torque of degree 2 is 3 GM/r^3 x cross I x, greatest at 45 degrees", "[tides]") {
  const Body box = make_body(ClosedSurface::from(test::box(Vec3(1, 2, 3), Vec3(4, 5, 6))), {}, 2);
  Monitor monitor;
  RigidBody body = free_body(box, 2, monitor);
  body.radius = 2;
  const double mass = 12, a = mass * 5 / 12, b = mass * 10 / 12, c = mass * 13 / 12; // about z, y, x
  const Orbit orbit = circular_orbit({"", 3e14, 0}, body, 8e6);
  const double scale = 3e14 / 8e6 / 8e6 / 8e6;
  CHECK(orbit.gradient == Approx(scale).epsilon(1e-15));
  const LongMat3 about_y = exponential(LongVec3(0, Real(pi) / 4, 0));
  const LongVec3 torque = orbit_torque(body, orbit, about_y).gravity;
  CHECK(double(std::abs(torque.y())) == Approx(1.5 * scale * (c - a)).epsilon(1e-13));
  CHECK(double(std::hypot(torque.x(), torque.z())) < 1e-16 * scale);
  CHECK(largest_quadrupole_torque(axes_of({a, b, c}), orbit) == Approx(1.5 * scale * (c - a)).epsilon(1e-13));
}

TEST_CASE("small librations of the full equations have the periods of the quartic", "[tides]") {
  const double tilt = 1e-5;
  // A Lagrangian body with axes of all sorts, and one that only its spin holds (DeBra and Delp).
  for (const auto& [moments, kind] :
       {std::pair(Vec3(1, 1.4, 1.9), Stability::lagrange), std::pair(Vec3(1.02, 1.9, 1), Stability::debra_delp)}) {
    const RigidBody body = body_with(moments);
    const Orbit orbit = low_orbit(body);
    std::array<int, 3> along = kind == Stability::lagrange ? std::array{0, 1, 2} : std::array{1, 2, 0};
    const Vec3 rising = kind == Stability::lagrange ? moments : Vec3(1, 1.02, 1.9);
    const Libration found = libration(axes_of(rising), orbit, along);
    CHECK(found.stability == kind);
    const Real n = orbit.rate;
    {
      const Real time = 2 * Real(pi) / found.pitch / 8;
      const State y = moved(body, orbit, {0, 0, tilt}, {0, 0, n}, time);
      CHECK(double(turned_by(y, orbit, time).z() / tilt) == Approx(std::sqrt(0.5)).epsilon(1e-9));
    }
    for (const double rate : found.roll_yaw) {
      const Real s = rate / n, kx = (moments[2] - moments[1]) / moments[0];
      const Real yaw = -tilt * (kx - s * s) / ((kx - 1) * s);
      const Real time = 2 * Real(pi) / rate;
      // omega = (roll' - n yaw, yaw' + n roll, n)
      const LongVec3 omega(0, n * (yaw * s + tilt), n);
      const LongVec3 quarter = turned_by(moved(body, orbit, {tilt, 0, 0}, omega, time / 4), orbit, time / 4);
      const LongVec3 whole = turned_by(moved(body, orbit, {tilt, 0, 0}, omega, time), orbit, time);
      const double size = tilt + std::abs(double(yaw));
      CHECK(double((quarter - LongVec3(0, yaw, 0)).norm()) < 1e-3 * tilt * size / tilt);
      CHECK(double((whole - LongVec3(tilt, 0, 0)).norm()) < 1e-3 * tilt * size / tilt);
    }
  }
}

TEST_CASE("stability of the six attitudes: one for good, and gyroscopic ones only where DeBra and Delp's region is",
          "[tides]") {
  const RigidBody body = body_with({1, 1.4, 1.9});
  const Orbit orbit = low_orbit(body);
  int lagrange = 0, gyroscopic = 0;
  for (const Libration& one : relative_equilibria(axes_of({1, 1.4, 1.9}), orbit)) {
    lagrange += one.stability == Stability::lagrange;
    gyroscopic += one.stability == Stability::debra_delp;
  }
  CHECK(lagrange == 1);
  CHECK(gyroscopic == 0);
  CHECK(relative_equilibria(axes_of({1, 1.4, 1.9}), orbit)[0].stability == Stability::lagrange);
  const auto all = relative_equilibria(axes_of({1, 1.02, 1.9}), orbit);
  CHECK(std::count_if(all.begin(), all.end(),
                      [](const Libration& l) { return l.stability == Stability::debra_delp; }) == 1);
}

TEST_CASE("an attitude that is called unstable is left, one that is called stable is kept, for twenty orbits",
          "[tides]") {
  for (const Vec3& moments : {Vec3(1.4, 1, 1.9), Vec3(1, 1.9, 1.4), Vec3(1, 1.4, 1.9), Vec3(1.02, 1.9, 1)}) {
    const RigidBody body = body_with(moments);
    const Orbit orbit = low_orbit(body);
    std::array<int, 3> along = {};
    Vec3 rising = moments;
    std::sort(rising.begin(), rising.end());
    for (int i = 0; i < 3; ++i)
      along[std::size_t(i)] = int(std::find(rising.begin(), rising.end(), moments[i]) - rising.begin());
    const bool stable = libration(axes_of(rising), orbit, along).stability != Stability::unstable;
    const Real time = 20 * 2 * Real(pi) / orbit.rate;
    const State y = moved(body, orbit, {1e-4L, 1e-4L, 1e-4L}, {0, 0, Real(orbit.rate)}, time);
    INFO(moments.transpose());
    const double tilt = double(turned_by(y, orbit, time).norm());
    CHECK(stable == (tilt < 5e-3));
  }
}

TEST_CASE("unstable attitudes too have the periods of what oscillates about them", "[tides]") {
  // Roll and yaw in units of n: x'' + kx x + (kx - 1) y' = 0, y'' + (1 + 3 g) ky y + (1 - ky) x' = 0.
  int growing = 0, single = 0, spiral = 0;
  for (const Vec3& rising : {Vec3(1, 1.4, 1.9), Vec3(1, 1.02, 1.9), Vec3(1, 1.8, 1.9), Vec3(1, 1.05, 1.1)}) {
    const Orbit orbit = low_orbit(body_with(rising));
    const double g = orbit.gradient / (orbit.rate * orbit.rate);
    for (const Libration& one : relative_equilibria(axes_of(rising), orbit)) {
      const Vec3 i(rising[one.axes[0]], rising[one.axes[1]], rising[one.axes[2]]);
      const double kx = (i.z() - i.y()) / i.x(), ky = (i.z() - i.x()) / i.y();
      Eigen::Matrix4d motion;
      motion << 0, 0, 1, 0, 0, 0, 0, 1, -kx, 0, 0, 1 - kx, 0, -(1 + 3 * g) * ky, ky - 1, 0;
      const Eigen::Vector4cd s = motion.eigenvalues();
      std::vector<double> rates;
      bool complex = false;
      for (int k = 0; k < 4; ++k) {
        if (s[k].imag() > 1e-9) rates.push_back(s[k].imag());
        complex = complex || (std::abs(s[k].imag()) > 1e-9 && std::abs(s[k].real()) > 1e-9);
      }
      rates.resize(2);
      std::sort(rates.begin(), rates.end());
      CAPTURE(rising.transpose(), one.axes[0], one.axes[1], one.axes[2]);
      for (std::size_t k : {0U, 1U})
        CHECK(one.roll_yaw[k] / orbit.rate == Approx(rates[k]).epsilon(1e-10).margin(1e-12));
      if (one.stability != Stability::unstable) continue;
      growing += rates[0] > 0 && !complex; // pitch alone leaves it
      single += rates[0] == 0 && rates[1] > 0;
      spiral += complex;
    }
  }
  CHECK(growing > 0);
  CHECK(single > 0);
  CHECK(spiral > 0);
}

TEST_CASE("a symmetric body is neutral about its axis, and a ball librates nowhere", "[tides]") {
  const Orbit orbit = low_orbit(body_with({1, 1, 1.5}));
  CHECK(libration(axes_of({1, 1, 1.5}), orbit, {0, 1, 2}).stability == Stability::neutral);
  CHECK(libration(axes_of({1, 1, 1.5}), orbit, {0, 1, 2}).pitch == 0);
  CHECK(capture_half_width(axes_of({1, 1, 1.5}), orbit) == 0);
  CHECK(is_isotropic(axes_of({2, 2, 2})));
  CHECK(largest_quadrupole_torque(axes_of({2, 2, 2}), orbit) == 0);
  for (const Libration& one : relative_equilibria(axes_of({2, 2, 2}), orbit))
    CHECK(one.stability == Stability::neutral);
}

TEST_CASE("higher degrees shift the attitude at rest to where Newton's torque holds the body", "[tides]") {
  const RigidBody body = body_of(tripod, 40);
  const Orbit orbit = circular_orbit({"", 1, 0}, body, 9);
  RigidBody tensors;
  tensors.quadrupole = body.quadrupole;
  tensors.trace = body.inertia().trace() / 2;
  const PrincipalAxes principal = principal_axes(tensors);
  for (const LongVec3& half : {LongVec3(1, 1, 1), LongVec3(-1, 1, -1), LongVec3(1, -1, -1), LongVec3(-1, -1, 1)}) {
    const LongMat3 axes = principal.axes.cast<Real>(), start = LongMat3(half.asDiagonal()) * axes.transpose();
    const ShiftedEquilibrium found = shifted_equilibrium(body, orbit, start);
    REQUIRE(found.found);
    const LongMat3 to_body = found.attitude.transpose();
    const LongVec3 z = to_body.col(2), x = -9 * to_body.col(0);
    const Real n = orbit.rate;
    const LongVec3 turning = n * n * z.cross(LongVec3(body.inertia().cast<Real>() * z));
    const LongVec3 rest = newton(tripod, 1, x).torque - turning;
    CHECK(double(rest.norm()) < 1e-13 * largest_quadrupole_torque(principal, orbit));
    CHECK(double(found.shift.norm()) > 1e-3);
    CHECK(double(found.shift.norm()) < 0.3);
    CHECK(double((exponential(found.shift) * start - found.attitude).norm()) < 1e-14);
    CHECK(double(newton(tripod, 1, 9 * start.transpose() * LongVec3(-1, 0, 0)).torque.norm()) >
          1e-3 * largest_quadrupole_torque(principal, orbit));
  }
}

TEST_CASE("a spin within the half width of capture librates, one beyond it goes on round", "[tides]") {
  const RigidBody body = body_with({1, 1.4, 1.9});
  const Orbit orbit = low_orbit(body);
  const double half = capture_half_width(axes_of({1, 1.4, 1.9}), orbit);
  CHECK(half == Approx(orbit.rate * std::sqrt(3 * 0.4 / 1.9)).epsilon(1e-13));
  const auto farthest = [&](double part) {
    double largest = 0;
    for (int k = 1; k <= 24; ++k) {
      const Real time = k / 8.0L * 2 * Real(pi) / half;
      const State y = moved(body, orbit, LongVec3::Zero(), {0, 0, orbit.rate + part * half}, time);
      const LongMat3 r = exponential(LongVec3(0, 0, -orbit.rate * time)) * rotation_of(y[0], y.segment<3>(1));
      largest = std::max(largest, std::abs(std::atan2(double(r(1, 0)), double(r(0, 0)))));
    }
    return largest;
  };
  CHECK(farthest(0.99) < pi / 2);
  CHECK(farthest(-0.99) < pi / 2);
  CHECK(farthest(1.01) > pi / 2);
}

TEST_CASE("the time to lock is omega r^6 I Q/(3 G M^2 k2 R^5)", "[tides]") {
  const double mass = 7.3e22, radius = 1.7e6, distance = 3.8e8, m = earth.mass();
  const RigidBody body = body_with(Vec3::Constant(0.4 * mass * radius * radius), mass);
  const Orbit orbit = circular_orbit(earth, body, distance);
  CHECK(orbit.rate == Approx(std::sqrt(gravitational_constant_si * (m + mass) / std::pow(distance, 3))).epsilon(1e-13));
  const double expected = 1e-4 * std::pow(distance, 6) * 0.4 * mass * radius * radius * 30 /
                          (3 * gravitational_constant_si * m * m * 0.024 * std::pow(radius, 5));
  CHECK(locking_time(body, orbit, 1e-4, 0.024, 30) == Approx(expected).epsilon(1e-12));
  for (const double love : {0.0, -0.1, 1.6, 1e300, std::nan("")})
    CHECK_THROWS_WITH(locking_time(body, orbit, 1e-4, love, 30), Catch::Contains("k2") && Catch::Contains("1.5"));
  for (const double quality : {0.0, 0.5, 1e13, 1e300, std::nan("")})
    CHECK_THROWS_WITH(locking_time(body, orbit, 1e-4, 0.024, quality), Catch::Contains("from 1 to 1e+12"));
  CHECK_THROWS_WITH(locking_time(body, orbit, 1e-4, 1e-300, 1e12), Catch::Contains("too long"));
  CHECK_THROWS_WITH(locking_time(body, orbit, 1e-310, 1, 1), Catch::Contains("too short"));
  CHECK(locking_time(body, orbit, 1e-4, 1.5, 1) > 0);
}

TEST_CASE("orbits through the body, of no size or about nothing are refused", "[tides]") {
  const RigidBody body = body_with({1, 1.4, 1.9});
  CHECK_THROWS_AS(circular_orbit(earth, body, body.radius), Error);
  CHECK_THROWS_AS(circular_orbit(earth, body, -1), Error);
  CHECK_THROWS_AS(circular_orbit({"", 0, 0}, body, 1e7), Error);
  CHECK_THROWS_AS(circular_orbit(earth, body, 1e300), Error);
  CHECK_THROWS_AS(body_with({1, 1, 1}, -1), Error);
  CHECK_THROWS_AS(body_with({0, 1, 1}), Error);
}
