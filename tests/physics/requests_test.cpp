// What the applications of the multipoles find, asked for from C++ without a command line.
#include "host/error.hpp"
#include "host/report/findings_report.hpp"
#include "host/requests/drop.hpp"
#include "host/requests/potential.hpp"
#include "host/requests/radiate.hpp"
#include "host/requests/tensors.hpp"
#include "host/requests/tides.hpp"
#include "host/requests/tip.hpp"

#include "tests/support/refusals.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using Catch::Contains;

namespace {

// A box of 1 x 2 x 3 feet as heavy as water.
BodyRequest box() {
  BodyRequest body;
  body.mesh = "builtin:box:1,2,3";
  body.length_unit = 0.3048;
  body.density = 1000;
  return body;
}

constexpr double foot = 0.3048, kilograms = 6000 * foot * foot * foot;

std::string text_of(const physics::Findings& found) {
  std::string text;
  write_findings(found, [&](std::string_view part) { text += part; });
  return text;
}

} // namespace

TEST_CASE("a body is loaded in SI with its units, or in its file's without", "[requests]") {
  Monitor monitor;
  const LoadedMass loaded = load_mass(box(), Motion::free, monitor);
  CHECK(loaded.units.stated);
  CHECK(loaded.units.metre == foot);
  CHECK(loaded.units.kilogram == Approx(1000 * foot * foot * foot).epsilon(1e-15));
  const physics::RigidBody body = rigid_body(loaded);
  CHECK(body.mass == Approx(kilograms).epsilon(1e-14));
  CHECK(body.inertia()(0, 0) == Approx(kilograms * 13 * foot * foot / 12).epsilon(1e-14));
  CHECK(free_body(loaded, 4, monitor).higher);
  BodyRequest plain = box();
  plain.length_unit.reset();
  plain.density.reset();
  const LoadedMass without = load_mass(plain, Motion::held, monitor);
  CHECK_FALSE(without.units.stated);
  CHECK(rigid_body(without).mass == Approx(6).epsilon(1e-15));
  CHECK_THROWS_WITH(require_units(without), Contains("no unit was stated"));
  plain.length = 0.9144; // its longest side
  CHECK(rigid_body(load_mass(plain, Motion::held, monitor)).mass == Approx(kilograms / 1000).epsilon(1e-14));
  plain.length_unit = 1;
  CHECK_THROWS_WITH(load_mass(plain, Motion::held, monitor), Contains("leave one out"));
}

TEST_CASE("tensors of a request are those of the textbook, and make a document", "[requests]") {
  Monitor monitor;
  const TensorsResult result = tensors({box(), true}, monitor);
  const double m = kilograms * foot * foot / 12;
  CHECK((*result.principal.moments - m * Vec3(5, 10, 13)).norm() < 1e-13 * m);
  CHECK_THAT(text_of(findings(result)), Contains("principal moments of inertia"));
}

TEST_CASE("a body in orbit is asked for by numbers", "[requests]") {
  Monitor monitor;
  TidesRequest request;
  request.body = box();
  request.radius = 6771e3;
  request.spin = 1;
  const TidesResult result = tides(request, monitor);
  CHECK(result.body.mass == Approx(kilograms).epsilon(1e-14));
  CHECK(result.orbit.rate == Approx(std::sqrt(3.986004e14 / std::pow(6771e3, 3))).epsilon(1e-9));
  CHECK(result.torque_quadrupole.gravity.norm() < 1e-12L * result.largest_torque);
  CHECK(result.equilibria.size() == 6);
  CHECK(result.caught == false);
  CHECK_THAT(text_of(findings(result)), Contains("orbital period"));
  request.body.length_unit.reset();
  request.body.density.reset();
  CHECK_THROWS_WITH(tides(request, monitor), Contains("no unit was stated"));
}

TEST_CASE("a body that is dropped without spin lands as it was held", "[requests]") {
  Monitor monitor;
  DropRequest request;
  request.body = box();
  request.height = 10;
  request.order = 2;
  const DropOutcome upright = drop(request, monitor);
  CHECK(upright.lands_on_its_feet());
  CHECK(upright.fall.speed == Approx(std::sqrt(2 * 9.82 * (10 - foot))).epsilon(2e-3));
  request.attitude = Held::upside_down;
  CHECK_FALSE(drop(request, monitor).lands_on_its_feet());
  CHECK_THAT(text_of(findings(upright)), Contains("lands on its feet"));
}

TEST_CASE("the waves of a body that turns, with units and without", "[requests]") {
  Monitor monitor;
  RadiateRequest request;
  request.body = box();
  request.axis = Vec3::UnitZ();
  request.octupole = true;
  const RadiationResult result = radiate(request, monitor);
  const double b_minus_a = kilograms * 3 * foot * foot / 12; // I_yy - I_xx changes sign each quarter turn
  const double power = 32 * 6.6743e-11 / (5 * std::pow(299792458.0, 5)) * b_minus_a * b_minus_a;
  CHECK(double(result.power) == Approx(power).epsilon(1e-12));
  CHECK(result.spin);
  CHECK(result.spherical_difference < 1e-14);
  CHECK_THAT(text_of(findings(result)), Contains("radiated power"));
  request.body.length_unit.reset();
  request.body.density.reset();
  CHECK_FALSE(radiate(request, monitor).spin);
}

TEST_CASE("the potential of a body is asked for at places, and so are its series' errors", "[requests]") {
  Monitor monitor;
  const auto backend = make_cpu_backend(1);
  PotentialRequest request;
  request.body = box();
  request.places = PointsRequest{{Vec3(100, 0, 0), Vec3(0, 100, 0)}, "far away"};
  request.lmax = 4;
  const PotentialResult far = potential(request, *backend, 1, monitor);
  CHECK(far.field.value[0] == Approx(-6.6743e-11 * kilograms / 100).epsilon(1e-5));
  CHECK(far.exact_points == 0);
  CHECK_THAT(text_of(findings(far, 20)), Contains("point by point"));
  request.places = SphereRequest{{{1, false, {}}, true}, 4};
  request.inside_exact = true;
  const PotentialResult near = potential(request, *backend, 1, monitor);
  CHECK(near.points.size() == std::size_t(near.grid->points()));
  CHECK(near.points.size() <= count_places(request.places));
  CHECK(near.radius_known());
  request.places = PointsRequest{{Vec3::Zero()}, "inside"};
  request.inside_exact = false;
  CHECK_THROWS_WITH(potential(request, *backend, 1, monitor), Contains("--inside exact"));
  const SeriesErrorsResult errors = series_errors({box(), {0, 2}, {3}}, *backend, 1, monitor);
  REQUIRE(errors.errors.rows.size() == 2);
  CHECK(errors.errors.rows[1].potential_max < errors.errors.rows[0].potential_max);
}

TEST_CASE("what tips a body is asked for by order", "[requests]") {
  Monitor monitor;
  const auto backend = make_cpu_backend(1);
  TipRequest request;
  request.body = box();
  request.body.mesh = "builtin:ellipsoid:3,2,1@2";
  request.orders = {0, 2};
  request.lmax = 4;
  request.resolution = 16;
  const TipResult result = tip(request, *backend, monitor);
  CHECK(result.body.mass == result.forces.mass);
  CHECK(result.expansion == "stretch");
  REQUIRE(result.orders.size() == 2);
  REQUIRE(result.orders[0].forces);
  CHECK(result.orders[0].forces->chosen().force < 1e-6); // a ball rolls
  CHECK(result.orders[0].forces->mass == Approx(result.body.mass).epsilon(1e-14));
  CHECK_THAT(text_of(findings(result)), Contains("by order of stretch"));
}

TEST_CASE("a box tips at half its width over its diagonal, however it is asked for", "[requests]") {
  Monitor monitor;
  const auto backend = make_cpu_backend(1);
  TipRequest request;
  request.body = box();
  request.as_modelled = true;
  request.side = physics::Side::left;
  request.push.profile = physics::square_pulse(1e6, 1);
  const TipResult result = tip(request, *backend, monitor);
  CHECK_FALSE(rebuilds_surfaces(request));
  // 3 wide, 2 high; the push is at the opposite edge.
  CHECK(result.forces.chosen().force == Approx(1.5 / std::hypot(2, 3)).epsilon(1e-12));
  REQUIRE(result.push);
  CHECK(result.push->pushed->outcome == physics::Outcome::tipped);
  CHECK(result.push->boundary.size() == 19);
  request.gravity = 0;
  CHECK_THROWS_WITH(tip(request, *backend, monitor), Contains("--gravity"));
}

TEST_CASE("requests of nonsense are refused in words, whoever makes them", "[requests]") {
  Monitor monitor;
  const auto refused = [&](auto&& call, const char* word) {
    try {
      call();
      FAIL("taken, and it should say: " << word);
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::bad_argument);
      CHECK_THAT(error.what(), Contains(word));
    }
  };
  const double nan = std::nan("");
  for (const Eigen::Matrix3d& r :
       {Eigen::Matrix3d(2 * Eigen::Matrix3d::Identity()), Eigen::Matrix3d(-Eigen::Matrix3d::Identity()),
        Eigen::Matrix3d(Eigen::Matrix3d::Zero()), Eigen::Matrix3d(Eigen::Matrix3d::Constant(nan))}) {
    BodyRequest turned = box();
    turned.rotation = r;
    refused([&] { load_mass(turned, Motion::held, monitor); }, "is not a rotation");
    TidesRequest orbit{box()};
    orbit.radius = 7e6;
    orbit.attitude = r.cast<long double>();
    refused([&] { tides(orbit, monitor); }, "is not a rotation");
    DropRequest fall{box()};
    fall.height = 10;
    fall.attitude = physics::LongMat3(r.cast<long double>());
    refused([&] { drop(fall, monitor); }, "is not a rotation");
  }
  for (const Vec3& direction : {Vec3(0, 5, 0), Vec3(0, 0, 0), Vec3(nan, 0, 0)}) {
    RadiateRequest turning{box()};
    turning.axis = direction;
    refused([&] { radiate(turning, monitor); }, "of length 1");
    DropRequest fall{box()};
    fall.height = 10;
    fall.feet = direction;
    refused([&] { drop(fall, monitor); }, "of length 1");
  }
  for (const int order : {-3, 1, 65}) {
    TidesRequest orbit{box()};
    orbit.radius = 7e6;
    orbit.order = order;
    refused([&] { tides(orbit, monitor); }, "must be from 2 to 64");
  }
  for (const double spin : {nan, -1.0}) {
    TidesRequest orbit{box()};
    orbit.radius = 7e6;
    orbit.spin = spin;
    refused([&] { tides(orbit, monitor); }, "the spin is");
  }
  BodyRequest body = box();
  body.origin = {"given", Vec3(nan, 0, 0)};
  refused([&] { load_mass(body, Motion::held, monitor); }, "must be finite");
  body.origin = {"moon", {}};
  refused([&] { load_mass(body, Motion::held, monitor); }, "has no point");
  for (const PlaceRequest& places :
       {PlaceRequest(PlaneRequest{7, {}, {{1}, true}, 5}), PlaceRequest(PlaneRequest{2, {}, {{1}, true}, 1}),
        PlaceRequest(SphereRequest{{{2}, true}, 0})})
    refused([&] { count_places(places); }, "a ");
  TipRequest pushed{box()};
  pushed.friction = nan;
  refused([&] { tip(pushed, *make_cpu_backend(), monitor); }, "friction");
}

TEST_CASE("numbers beyond the bounds of the command line are refused by the calls too", "[requests]") {
  using test::refuses;
  Monitor monitor;
  const auto cpu = make_cpu_backend(1);
  PotentialRequest field{box()};
  field.places = PointsRequest{{Vec3(100, 0, 0)}, "far away"};
  field.lmax = largest_potential_degree + 1;
  refuses([&] { potential(field, *cpu, 1, monitor); }, "the degree of the series is 1537");
  field.lmax = 2;
  field.derivatives = Derivatives(17);
  refuses([&] { potential(field, *cpu, 1, monitor); }, "number 17 of its kind: there are 0 to 2");
  refuses([&] { count_places(PlaneRequest{2, {}, {{1}, true}, 8193}); }, "8193");
  CHECK(count_places(PlaneRequest{2, {}, {{1}, true}, 8192}) == std::size_t(8192) * 8192);
  TipRequest pushed{box()};
  pushed.side = physics::Side(17);
  refuses([&] { tip(pushed, *cpu, monitor); }, "the side is number 17");
  pushed.side.reset();
  pushed.push.punch = 1e31;
  refuses([&] { tip(pushed, *cpu, monitor); }, "the force of the punch, in N, is 1e+31: 1e-30 to 1e+30 are possible");
  pushed.push.punch = 5000;
  pushed.resolution = 9000;
  refuses([&] { tip(pushed, *cpu, monitor); }, "the resolution is 9000: 0 to 8192");
  DropRequest fall{box()};
  fall.height = 10;
  fall.attitude = Held(-1);
  refuses([&] { drop(fall, monitor); }, "the attitude is number -1");
  RadiateRequest still{box()};
  still.omega = 0;
  refuses([&] { radiate(still, monitor); }, "the rate of the turn is 0 rad/s: it must be above 0");
  still.omega = 1e-19;
  refuses([&] { radiate(still, monitor); }, "slower than a turn in 400 Gyr");
  refuses([] { make_cpu_backend(4'000'000'000U); }, "the threads of the CPU path are 4000000000: 0 to 4096");
}

TEST_CASE("nothing on an orbit is faster than light", "[requests][tides]") {
  using test::refuses;
  Monitor monitor;
  TidesRequest orbit{box()};
  orbit.radius = 6771e3;
  orbit.centre = {"", 1e300 * 6.6743e-11, 0};
  refuses([&] { tides(orbit, monitor); }, "faster than light: lower --mass or take a wider --orbit");
  orbit.centre.gm = 1e22; // 0.13 of the speed of light
  CHECK_THAT(tides(orbit, monitor).subject.notes.back(), Contains("0.13 of the speed of light"));
  orbit.centre = physics::earth;
  orbit.spin = 1e12;
  refuses([&] { tides(orbit, monitor); }, "faster than light: lower --spin");
  orbit.spin = 1;
  for (const std::string& note : tides(orbit, monitor).subject.notes) CHECK_THAT(note, !Contains("speed of light"));
}
