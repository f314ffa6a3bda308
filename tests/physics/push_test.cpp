#include "host/physics/push.hpp"

#include "host/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace cowgpu;
using namespace cowgpu::physics;
using Catch::Contains;

namespace {

constexpr double g = 9.80665;

// A box of mass 60, 0.8 wide and 2 high, pushed at its upper edge.
Rocker box_rocker(bool turns_with_body = true) {
  const double mass = 60, d = 0.4, h = 1, r = std::hypot(d, h);
  return {mass, g, mass * 4 * r * r / 3, r, std::atan2(d, h), 2 * r, turns_with_body};
}

double rate(const Rocker& r) {
  return std::sqrt(r.mass * r.gravity * r.radius / r.inertia);
}

// A push so short that nothing moves while it lasts.
Profile blow(const Rocker& rocker, double part_of_least_impulse) {
  const double force = 1e12 * rocker.threshold();
  return square_pulse(force, part_of_least_impulse * rocker.least_impulse() / force);
}

// Incomplete elliptic integral of the first kind for the parameter -n < 0.
double elliptic_negative(double phi, double n) {
  const double k = std::sqrt(n / (1 + n));
  return (std::comp_ellint_1(k) - std::ellint_1(k, std::acos(0.0) - phi)) / std::sqrt(1 + n);
}

} // namespace

TEST_CASE("threshold and smallest impulse of a box in closed form", "[push]") {
  const Rocker box = box_rocker();
  CHECK(box.threshold() == Approx(60 * g * 0.4 / (2 * std::hypot(0.4, 1.0))).epsilon(1e-14));
  const double energy = 60 * g * (std::hypot(0.4, 1.0) - 1);
  CHECK(box.least_energy() == Approx(energy).epsilon(1e-13));
  CHECK(box.least_impulse() == Approx(std::sqrt(2 * box.inertia * energy) / box.lever).epsilon(1e-13));
  CHECK(square_pulse(300, 0.5).impulse() == 150);
  CHECK(Profile{{0, 1, 1, 3}, {0, 2, 5, 1}}.impulse() == 7);
}

TEST_CASE("a push below the threshold never lifts the body, and one above always tips it if it lasts", "[push]") {
  for (const bool turns : {true, false}) {
    const Rocker box = box_rocker(turns);
    const PushResult below = push(box, square_pulse(box.threshold() * (1 - 1e-12), 1e6));
    CHECK(below.outcome == Outcome::never_lifted);
    CHECK(below.peak_tilt == 0);
    CHECK(std::isnan(below.lift_time));
    CHECK(push(box, square_pulse(box.threshold() * (1 + 1e-6), 100)).outcome == Outcome::tipped);
    CHECK(std::isinf(box.least_duration(box.threshold())));
    CHECK(std::isinf(box.least_duration(0.5 * box.threshold())));
  }
}

TEST_CASE("after a blow the body moves as an inverted pendulum: elliptic integrals", "[push]") {
  const Rocker box = box_rocker();
  const double k = rate(box), alpha = box.balance;
  for (const double part : {1.001, 1.2, 3.0}) {
    const double omega = part * box.least_impulse() * box.lever / box.inertia;
    const double c = omega * omega - 2 * k * k * (1 - std::cos(alpha));
    const PushResult tipped = push(box, blow(box, part));
    CHECK(tipped.outcome == Outcome::tipped);
    CHECK(tipped.end_time == Approx(2 / std::sqrt(c) * elliptic_negative(alpha / 2, 4 * k * k / c)).epsilon(1e-9));
    CHECK(tipped.peak_tilt == alpha);
  }
  for (const double part : {0.999, 0.8, 0.2}) {
    const double omega = part * box.least_impulse() * box.lever / box.inertia;
    const double c = omega * omega - 2 * k * k * (1 - std::cos(alpha));
    const double s = std::sqrt(-c) / (2 * k), modulus = std::sqrt(1 - s * s);
    const double up =
        (std::comp_ellint_1(modulus) - std::ellint_1(modulus, std::asin(std::cos(alpha / 2) / modulus))) / k;
    const PushResult back = push(box, blow(box, part));
    INFO(part);
    CHECK(back.outcome == Outcome::fell_back);
    CHECK(back.peak_tilt == Approx(alpha - 2 * std::asin(s)).epsilon(1e-9));
    CHECK(back.end_time == Approx(2 * up).epsilon(1e-9));
  }
}

TEST_CASE("the boundary between tipping and falling back is where quadrature and integration meet", "[push]") {
  for (const bool turns : {true, false}) {
    const Rocker box = box_rocker(turns);
    for (const double over : {1.0001, 1.05, 1.5, 4.0, 60.0, 1e4}) {
      const double force = over * box.threshold(), least = box.least_duration(force);
      INFO(over);
      CHECK(push(box, square_pulse(force, least * (1 + 1e-10))).outcome == Outcome::tipped);
      CHECK(push(box, square_pulse(force, least * (1 - 1e-10))).outcome == Outcome::fell_back);
    }
  }
}

TEST_CASE("the boundary tends to the smallest impulse for strong pushes and to infinity at the threshold", "[push]") {
  const Rocker box = box_rocker();
  const auto excess = [&](double over) {
    const double force = over * box.threshold();
    return force * box.least_duration(force) / box.least_impulse() - 1;
  };
  CHECK(excess(1e8) < 1e-7);
  CHECK(excess(1e3) / excess(1e4) == Approx(10).epsilon(0.01));
  // Where it just begins, theta grows as cosh: each factor of 100 nearer takes log(100)/rate longer.
  const double near = box.least_duration(box.threshold() * (1 + 1e-6)),
               nearer = box.least_duration(box.threshold() * (1 + 1e-8));
  CHECK(nearer - near == Approx(std::log(100) / (rate(box) * std::sqrt(std::cos(box.balance)))).epsilon(1e-4));
  double last = std::numeric_limits<double>::infinity();
  for (double over = 1.001; over < 100; over *= 1.3) {
    const double least = box.least_duration(over * box.threshold());
    CHECK(least < last);
    last = least;
  }
}

TEST_CASE("a push whose direction stays in space needs longer than one that turns with the body", "[push]") {
  const Rocker body = box_rocker(true), space = box_rocker(false);
  CHECK(space.threshold() == body.threshold());
  for (const double over : {1.1, 2.0, 10.0})
    CHECK(space.least_duration(over * body.threshold()) > body.least_duration(over * body.threshold()));
}

TEST_CASE("a table of the same push in pieces gives the same motion", "[push]") {
  const Rocker box = box_rocker();
  const double force = 2 * box.threshold(), time = 0.9 * box.least_duration(force);
  const PushResult whole = push(box, square_pulse(force, time));
  const Profile pieces{{0, 0.3 * time, 0.3 * time, 0.7 * time, time, time, 5},
                       {force, force, force, force, force, 0, 0}};
  const PushResult cut = push(box, pieces);
  CHECK(cut.outcome == whole.outcome);
  CHECK(cut.peak_tilt == Approx(whole.peak_tilt).epsilon(1e-10));
  CHECK(cut.end_time == Approx(whole.end_time).epsilon(1e-10));
  CHECK(cut.lift_time == 0);
}

TEST_CASE("a push that grows lifts the body when it passes the threshold", "[push]") {
  const Rocker box = box_rocker();
  const double threshold = box.threshold();
  const PushResult result = push(box, {{1, 3}, {0, 4 * threshold}});
  CHECK(result.lift_time == Approx(1.5).epsilon(1e-14));
  CHECK(result.outcome == Outcome::tipped);
  CHECK(push(box, {{1, 3, 4}, {0, 0.999 * threshold, 0}}).outcome == Outcome::never_lifted);
}

TEST_CASE("a body that fell back lies still until the next push lifts it", "[push]") {
  const Rocker box = box_rocker();
  const double force = 3 * box.threshold(), least = box.least_duration(force);
  const double again = 10;
  const Profile twice{{0, 0.5 * least, 0.5 * least, again, again, again + 1.01 * least},
                      {force, force, 0, 0, force, force}};
  const PushResult result = push(box, twice);
  CHECK(result.outcome == Outcome::tipped);
  CHECK(result.lift_time == 0);
  CHECK(result.end_time > again + least);
  Profile weak = twice;
  weak.time.back() = again + 0.99 * least;
  CHECK(push(box, weak).outcome == Outcome::fell_back);
}

TEST_CASE("the friction that a push takes: the static one below the threshold, and of a blow the height over the width",
          "[push]") {
  const Rocker box = box_rocker();
  const double force = 0.9 * box.threshold(), alpha = box.balance;
  const PushResult held = push(box, square_pulse(force, 1));
  CHECK(held.friction_needed == Approx(force * std::cos(alpha) / (60 * g - force * std::sin(alpha))).epsilon(1e-13));
  // I = 4 m r^2/3 and L = 2 r: inertia at the edge takes 3/2 F n, so the ground gives F n/2.
  CHECK(push(box, blow(box, 0.1)).friction_needed == Approx(1 / std::tan(alpha)).epsilon(1e-9));
  // Pushed near the edge instead, the body would be lifted off the ground.
  Rocker low = box;
  low.lever = 0.3 * box.radius;
  CHECK(std::isinf(push(low, blow(low, 0.5)).friction_needed));
}

TEST_CASE("the force that just tips within a time is that whose least duration is the time", "[push]") {
  for (const bool turns : {true, false}) {
    const Rocker box = box_rocker(turns);
    for (const double over : {1.001, 2.0, 1e6}) {
      const double force = over * box.threshold();
      CHECK(box.least_force(box.least_duration(force)) == Approx(force).epsilon(1e-11));
    }
    for (const double duration : {1e6, 1e300})
      CHECK(box.least_force(duration) == Approx(box.threshold()).epsilon(1e-15));
  }
}

TEST_CASE("a push that goes on long after the body has tipped ends with it", "[push]") {
  const Rocker box = box_rocker();
  const double force = 3 * box.threshold();
  const PushResult brief = push(box, square_pulse(force, 10)), lasting = push(box, square_pulse(force, 1e300));
  CHECK(lasting.outcome == Outcome::tipped);
  CHECK(lasting.end_time == Approx(brief.end_time).epsilon(1e-12));
  CHECK(lasting.friction_needed == Approx(brief.friction_needed).epsilon(1e-12));
}

TEST_CASE("a push is left off where the caller wants to stop", "[push]") {
  struct Stop final : Monitor {
    bool stopped() const override { return true; }
  };
  const Rocker box = box_rocker();
  const double force = 3 * box.threshold();
  const auto interrupted = [](const auto& work) {
    try {
      work();
      FAIL("it goes on");
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::interrupted);
    }
  };
  interrupted([&] { push(box, square_pulse(force, 1), Stop()); });
  interrupted([&] { box.least_duration(force, Stop()); });
  interrupted([&] { box.least_force(1, Stop()); });
}

TEST_CASE("pushes that make no sense are refused", "[push]") {
  const Rocker box = box_rocker();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const Profile& profile, const char* word) {
    try {
      push(box, profile);
      FAIL("it is taken");
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::bad_argument);
      CHECK_THAT(error.what(), Contains(word));
    }
  };
  refused({}, "at least two rows");
  refused({{0}, {1}}, "at least two rows");
  refused({{0, 1}, {1}}, "at least two rows");
  refused({{0, 1}, {1, -1}}, "row 2");
  refused({{0, nan}, {1, 1}}, "row 2");
  refused({{0, 1}, {nan, 1}}, "row 1");
  refused({{-1, 1}, {1, 1}}, "row 1");
  refused({{0, 2, 1}, {1, 1, 1}}, "row 3");
  refused({{0, 2}, {1e308, 1e308}}, "impulse");
  Rocker ball = box;
  ball.balance = 0;
  CHECK_THROWS_AS(push(ball, square_pulse(1, 1)), Error);
}
