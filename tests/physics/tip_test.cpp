#include "host/physics/tip.hpp"

#include "host/error.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace cowgpu;
using namespace cowgpu::physics;
using namespace cowgpu::test;
using Catch::Contains;

namespace {

RigidBody body_of(RawMesh mesh, double density = 1) {
  return solid_body(make_body(ClosedSurface::from(std::move(mesh)), {}, density));
}

TriangleSurface surface_of(const RawMesh& mesh) {
  TriangleSurface surface;
  surface.vertices = mesh.vertices;
  surface.faces = mesh.faces;
  return surface;
}

RigidBody smooth_body(const RawMesh& mesh, double mass = 1) {
  std::string note;
  return physics::smooth_body(surface_of(mesh), mass, note);
}

void check_point(const Vec3& found, const Vec3& expected, double tolerance = 1e-12) {
  INFO(found.transpose() << " and " << expected.transpose());
  CHECK((found - expected).norm() < tolerance);
}

void cannot_stand(RigidBody body, const StandOptions& how, const char* word) {
  try {
    stand(std::move(body), how);
    FAIL("it stands");
  } catch (const Error& error) {
    CHECK(error.fault() == Fault::cannot_stand);
    CHECK_THAT(error.what(), Contains(word));
  }
}

} // namespace

TEST_CASE("a box tips about its edge, pushed at the opposite one: half its width over the diagonal", "[tip]") {
  const double wide = 1.5, high = 2, deep = 0.7; // along x, y, z
  const Vec3 corner(10, -3, 5), b = corner + Vec3(wide, high, deep) / 2;
  const Stance stance = stand(body_of(box({wide, high, deep}, corner), 3), {});
  const double d = deep / 2, h = high / 2, r = std::hypot(d, h), mass = 3 * wide * high * deep;
  for (const Side side : {Side::left, Side::right}) {
    const double sign = side == Side::right ? 1 : -1;
    const Tipping t = tipping(stance, side);
    check_point(t.pivot, b + Vec3(0, -h, sign * d));
    check_point(t.point, b + Vec3(0, h, -sign * d));
    check_point(t.direction, Vec3(0, d / r, sign * h / r));
    CHECK(t.lever == Approx(2 * r).epsilon(1e-13));
    CHECK(t.force == Approx(d / (2 * r)).epsilon(1e-13));
    CHECK(t.force_paper_balance == Approx(d / (r + d * d / r)).epsilon(1e-13));
    const double arm = std::hypot(wide / 2, d), across = std::hypot(wide / 2, r);
    REQUIRE(t.force_paper_literal);
    CHECK(*t.force_paper_literal == Approx(arm / (across + d / r * arm)).epsilon(1e-12));
    CHECK(t.friction_needed == Approx(t.force * h / r / (1 - t.force * d / r)).epsilon(1e-13));
    CHECK(t.slip_force(t.friction_needed) == Approx(t.force).epsilon(1e-13));
    CHECK(t.inertia == Approx(mass * (high * high + deep * deep) / 3).epsilon(1e-13));
    CHECK(t.balance_angle() == Approx(std::atan2(deep, high)).epsilon(1e-13));
  }
  CHECK(stance.attitude.angle == 0);
  CHECK_FALSE(stance.held);
  CHECK(weaker_side(tipping(stance, Side::left), tipping(stance, Side::right)) == Side::right);
}

TEST_CASE("with friction's torque the balance about the barycentre is that about the pivot", "[tip]") {
  std::mt19937 random(11);
  for (int body = 0; body < 20; ++body) {
    const Stance stance = stand(body_of(convex_polyhedron(random, 20, 40)), {});
    for (const Side side : {Side::left, Side::right}) {
      const Tipping t = tipping(stance, side);
      const Vec3 &b = stance.body.centre, push = t.force * t.direction;
      const double normal = 1 - push.y(), friction = -push.z();
      const Vec3 ground(0, normal, friction);
      const double torque = ((t.point - b).cross(push) + (t.pivot - b).cross(ground)).x();
      CHECK(std::abs(torque) < 1e-12 * t.lever);
      const double paper = t.force_paper_balance * (t.point - b).norm();
      CHECK(paper == Approx((1 - t.force_paper_balance * t.direction.y()) * t.offset).epsilon(1e-11));
      CHECK(t.force_paper_balance > t.force);
    }
  }
}

TEST_CASE("a tetrahedron's forces to either side are those of its cross-section", "[tip]") {
  const Stance stance = stand(body_of(tetrahedron({0, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {0, 3, 0})), {});
  const Tipping right = tipping(stance, Side::right), left = tipping(stance, Side::left);
  check_point(right.pivot, {0, 0, 1});
  check_point(right.point, {0, 1.5, -0.5});
  CHECK(right.force == Approx(1 / (2 * std::sqrt(2.0))).epsilon(1e-13));
  check_point(left.pivot, {0, 0, -1});
  check_point(left.point, {0, 1, 2.0 / 3});
  CHECK(left.force == Approx(1.25 / (4.0 / 3 * std::hypot(0.75, 1.25))).epsilon(1e-13));
  CHECK(weaker_side(left, right) == Side::right);
}

TEST_CASE("the force over the weight does not depend on place, unit, density or a tilt that settling undoes", "[tip]") {
  const RawMesh mesh = tetrahedron({0, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {0, 3, 0});
  const Tipping plain = tipping(stand(body_of(mesh), {}), Side::left);
  const Eigen::Matrix3d tilt = Eigen::AngleAxisd(0.2, Vec3::UnitX()).toRotationMatrix();
  const RawMesh other = rotated(scaled(translated(mesh, {3, 2, -1}), {2.5, 2.5, 2.5}), tilt);
  const Stance stance = stand(body_of(other, 1000), {});
  CHECK(stance.attitude.angle == Approx(0.2).epsilon(1e-12));
  const Tipping moved = tipping(stance, Side::left);
  CHECK(moved.force == Approx(plain.force).epsilon(1e-12));
  CHECK(moved.force_paper_balance == Approx(plain.force_paper_balance).epsilon(1e-12));
  CHECK(*moved.force_paper_literal == Approx(*plain.force_paper_literal).epsilon(1e-12));
  CHECK(moved.inertia == Approx(plain.inertia * 1000 * std::pow(2.5, 5)).epsilon(1e-12));
}

TEST_CASE("a ball is tipped by nothing, and its triangulation by less and less", "[tip]") {
  double last = 1;
  for (int level = 1; level <= 4; ++level) {
    const RawMesh ball = icosphere(level, 2);
    const Tipping rolls = tipping(stand(smooth_body(ball), {}), Side::right);
    CHECK(rolls.rolls);
    CHECK(rolls.force == 0);
    CHECK(rolls.force_paper_balance == 0);
    CHECK(rolls.friction_needed == 0);
    CHECK(rolls.point.y() - rolls.pivot.y() == Approx(4).epsilon(0.2));
    const Tipping facets = tipping(stand(body_of(ball), {}), Side::right);
    CHECK(facets.force > 0);
    CHECK(facets.force < last);
    last = facets.force;
  }
  CHECK(last < 0.02);
}

TEST_CASE("a smooth body on two feet tips about the outer one", "[tip]") {
  const RawMesh dumbbell = together(translated(icosphere(4), {0, 0, 2}), translated(icosphere(4), {0, 0, -2}));
  const Stance stance = stand(smooth_body(dumbbell), {.as_modelled = true, .contact_tolerance = 1e-3});
  CHECK(stance.feet.size() == 2);
  const Tipping t = tipping(stance, Side::left);
  CHECK_FALSE(t.rolls);
  CHECK(t.force == Approx(1 / std::sqrt(5.0)).epsilon(0.02));
  // Side by side along x it rolls.
  const RawMesh along = together(translated(icosphere(4), {0.8, 0, 0}), translated(icosphere(4), {-0.8, 0, 0}));
  const Stance rolling = stand(smooth_body(along), {.as_modelled = true, .contact_tolerance = 1e-3});
  CHECK(rolling.feet.size() == 2);
  CHECK(tipping(rolling, Side::left).force == 0);
}

TEST_CASE("a surface that is inside out is turned, and an order keeps the mass of the whole", "[tip]") {
  std::string note;
  const RigidBody turned = physics::smooth_body(surface_of(flipped(box({1, 2, 3}))), 12, note);
  CHECK(note == "inside out; turned");
  CHECK(turned.mass == Approx(12).epsilon(1e-15));
  check_point(turned.centre, {0.5, 1, 1.5});
  CHECK(turned.inertia()(0, 0) == Approx(13).epsilon(1e-14));
}

TEST_CASE("a body whose barycentre hangs over cannot stand as modelled, but settles", "[tip]") {
  const RawMesh hook = together(box({1, 3, 1}), box({1, 1, 7}, {0, 3, 0}));
  cannot_stand(body_of(hook), {.as_modelled = true}, "falls to the right");
  const Stance stance = stand(body_of(hook), {});
  CHECK(stance.contact.margin > 0);
  CHECK(stance.attitude.angle == Approx(std::atan2(1, 2)).epsilon(1e-13)); // on the foot's edge and the arm's end
  // Fore and aft it counts as held.
  const Stance held = stand(body_of(together(box({1, 3, 1}), box({7, 1, 1}, {0, 3, 0}))), {.as_modelled = true});
  CHECK(held.held);
  CHECK(tipping(held, Side::right).offset == Approx(0.5).epsilon(1e-13));
}

TEST_CASE("parts count in the mass, the contact and the point of the push", "[tip]") {
  // A box on a wider slab, with a heavy part up on its left.
  ClosedSurface slab = ClosedSurface::from(box({2, 1, 4}, {-1, 0, -2}));
  std::vector<Part> parts;
  parts.emplace_back(ClosedSurface::from(box({2, 1, 1}, {-1, 1, -2})), 8);
  const Body body = make_body(std::move(slab), {}, 1, std::move(parts));
  const Stance stance = stand(solid_body(body), {});
  check_point(stance.body.centre, {0, 1.16666666666666667, -1});
  CHECK(stance.body.mass == Approx(24).epsilon(1e-15));
  const Tipping right = tipping(stance, Side::right);
  CHECK(right.offset == Approx(3).epsilon(1e-13));
  // From (0, 2) up to the left: out of the slab's top at none, through the part's left side at z = -2.
  check_point(right.point, {0, 4 * (7.0 / 6) / 3, -2});
  CHECK(right.force == Approx(3 / std::hypot(4, 14.0 / 9)).epsilon(1e-13));
  // Steiner: of the slab and the part about x through the pivot.
  const double slab_about = 8 * (17.0 / 12 + 0.25 + 4), part_about = 16 * (2.0 / 12 + 2.25 + 3.5 * 3.5);
  CHECK(right.inertia == Approx(slab_about + part_about).epsilon(1e-13));
}

TEST_CASE("a hole takes mass away and holds nothing: the body does not stand on it, nor is it pushed at it", "[tip]") {
  const Vec3 half(0.5, 1, 1.5);
  for (const Vec3& corner : {Vec3(-0.25, -1.45, -0.25), Vec3(-0.25, 0.9, -1.6), Vec3(-0.25, -0.25, -0.25)}) {
    std::vector<Part> parts;
    parts.emplace_back(ClosedSurface::from(box({0.5, 0.5, 0.5}, corner)), -0.01);
    const Body body = make_body(ClosedSurface::from(box({1, 2, 3}, -half)), {}, 1, std::move(parts));
    const Stance stance = stand(solid_body(body), {});
    INFO(corner.transpose());
    CHECK(stance.body.mass == Approx(6 - 0.01 / 8).epsilon(1e-15));
    CHECK(stance.contact.ground == -1);
    CHECK(stance.contact.support.size() == 4);
    for (const Side side : {Side::left, Side::right}) {
      const Vec3 point = tipping(stance, side).point;
      CHECK(point.y() < 1 + 1e-12);
      CHECK(std::abs(point.z()) < 1.5 + 1e-12);
    }
  }
}

TEST_CASE("a body of negative mass is told what it weighs", "[tip]") {
  try {
    body_of(box({1, 2, 3}), -1);
    FAIL("it weighs something");
  } catch (const Error& error) {
    CHECK(error.fault() == Fault::bad_argument);
    CHECK_THAT(error.what(), Contains("the body weighs -6"));
  }
}

TEST_CASE("the benchmark as modelled takes 1.4 to 1.8 kN by contact patch, as the paper's 'factor of a few'",
          "[tip][paper]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const double unit = 2.39;
  const RigidBody body = body_of(scaled(cow->mesh(), {unit, unit, unit}), 1000);
  const double weight = body.mass * standard_gravity;
  CHECK(weight == Approx(7159.87).epsilon(1e-5));
  const auto newtons = [&](double tolerance) {
    const Stance stance = stand(body, {.as_modelled = true, .contact_tolerance = tolerance * unit});
    CHECK(stance.held == (tolerance < 0.0053)); // the fore hooves are 0.0053 higher
    return tipping(stance, weaker_side(tipping(stance, Side::left), tipping(stance, Side::right))).force * weight;
  };
  CHECK(newtons(0) == Approx(1411.6).epsilon(1e-4));
  CHECK(newtons(0.003) == Approx(1781.7).epsilon(1e-4));
  CHECK(newtons(0.006) == Approx(1820.4).epsilon(1e-4));
  const Stance settled = stand(body, {});
  CHECK(settled.contact.support.size() == 4);
  CHECK(settled.attitude.angle == Approx(0.0104311).epsilon(1e-4));
  const Tipping t = tipping(settled, Side::right);
  CHECK(t.force * weight == Approx(1443.75).epsilon(1e-4));
  // The literal arm counts the hind hooves' offset of 0.27 fore and aft.
  CHECK(std::abs(t.support.x() - settled.body.centre.x()) > 0.26 * unit);
  CHECK(*t.force_paper_literal > 1.8 * t.force_paper_balance);
}
