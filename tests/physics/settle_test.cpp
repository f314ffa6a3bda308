#include "host/physics/settle.hpp"

#include "host/error.hpp"
#include "host/mesh/convex_hull.hpp"
#include "host/mesh/geometry.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::physics;
using namespace cowgpu::test;

namespace {

constexpr double pi = std::numbers::pi;

Eigen::Matrix3d turn(double angle, const Vec3& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

Vec3 centre(const RawMesh& mesh) {
  return centre_of_mass(mesh.vertices, mesh.faces);
}

std::vector<Vec3> settled(const RawMesh& mesh, Attitude& attitude) {
  attitude = settle(mesh.vertices, centre(mesh));
  return rotated(mesh, attitude.rotation).vertices;
}

// The nearest point to the origin of the convex hull of a few points in the plane.
Eigen::Vector2d nearest_of_hull(const std::vector<Eigen::Vector2d>& points) {
  Eigen::Vector2d best = points[0];
  const auto take = [&](const Eigen::Vector2d& p) {
    if (p.norm() < best.norm()) best = p;
  };
  for (const auto& a : points)
    for (const auto& b : points) {
      const Eigen::Vector2d d = b - a;
      take(d.squaredNorm() > 0 ? Eigen::Vector2d(a + std::clamp(-a.dot(d) / d.squaredNorm(), 0.0, 1.0) * d) : a);
      for (const auto& c : points) {
        const auto side = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
          return p.x() * q.y() - p.y() * q.x();
        };
        if (side(a, b) > 0 && side(b, c) > 0 && side(c, a) > 0) return Eigen::Vector2d::Zero();
      }
    }
  return best;
}

// The same by small turns: what is near the ground carries, and the body turns about a level axis away from the nearest point of
// that, without turning about the vertical.
Eigen::Matrix3d rolled_slowly(const std::vector<Vec3>& vertices, const Vec3& b, double step) {
  Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 2000000; ++i) {
    std::vector<Vec3> at;
    double ground = 1e300;
    for (const Vec3& v : vertices) {
      at.emplace_back(r * (v - b));
      ground = std::min(ground, at.back().y());
    }
    std::vector<Eigen::Vector2d> carries;
    for (const Vec3& v : at)
      if (v.y() < ground + 2 * step) carries.emplace_back(v.x(), v.z());
    const Eigen::Vector2d near = nearest_of_hull(carries);
    if (near.norm() < 1e-9) return r;
    // b is on the other side of the point that carries, and comes down.
    const Vec3 way = Vec3(-near.x(), 0, -near.y()).normalized();
    r = turn(step, Vec3::UnitY().cross(way)) * r;
  }
  FAIL("it rolls on and on");
  return r;
}

// The hull of a few random points, turned so that one of its facets is on the ground.
RawMesh on_a_facet(std::mt19937& random, std::size_t count) {
  std::uniform_real_distribution<double> in(-1, 1);
  RawMesh mesh;
  for (std::size_t i = 0; i < count; ++i) mesh.vertices.emplace_back(in(random), 0.5 * in(random), in(random));
  mesh.faces = convex_hull(mesh.vertices);
  const Face& f = mesh.faces[random() % mesh.faces.size()];
  const Vec3 a = mesh.vertices[f[0]];
  const Vec3 normal = (mesh.vertices[f[1]] - a).cross(mesh.vertices[f[2]] - a).normalized();
  return rotated(mesh, Eigen::Quaterniond::FromTwoVectors(normal, -Vec3::UnitY()).toRotationMatrix());
}

double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

} // namespace

TEST_CASE("a box that stands flat stays as it is", "[settle]") {
  const RawMesh mesh = box({3, 2, 1}, {7, -4, 2});
  const Attitude attitude = settle(mesh.vertices, centre(mesh));
  CHECK(attitude.rotation.isIdentity(0));
  CHECK(attitude.angle == 0);
  CHECK(attitude.rolls.empty());
  CHECK_FALSE(attitude.balanced);
}

TEST_CASE("a tilted box settles by the angle it was tilted, or falls on to the next side past the balance",
          "[settle]") {
  const RawMesh mesh = box({3, 2, 1}, {-1.5, -1, -0.5});
  const double diagonal = std::atan2(1.0, 2.0); // it balances on the edge along x
  for (const double angle : {0.01, 0.3, diagonal - 1e-6, diagonal + 1e-6, 0.9}) {
    const RawMesh tilted = rotated(mesh, turn(angle, Vec3::UnitX()));
    const Attitude attitude = settle(tilted.vertices, Vec3::Zero());
    INFO(angle);
    CHECK(attitude.angle == Approx(angle < diagonal ? angle : pi / 2 - angle).epsilon(1e-13));
    const Contact on = contact(rotated(tilted, attitude.rotation).vertices, Vec3::Zero(), 0);
    CHECK(on.patch.size() == 4);
    CHECK(on.support.size() == 4);
    CHECK(on.ground == Approx(angle < diagonal ? -1 : -0.5).epsilon(1e-14));
    CHECK(on.margin == Approx(angle < diagonal ? 0.5 : 1).epsilon(1e-13));
  }
}

TEST_CASE("a box on a corner rolls over an edge on to a side, the barycentre lower and lower", "[settle]") {
  const RawMesh mesh = box({3, 2, 1}, {-1.5, -1, -0.5});
  // A little off the attitude in which a corner is right below: it falls on the widest side last.
  const RawMesh cornered = rotated(mesh, turn(0.7, {1, 0.2, 0.5}));
  Attitude attitude;
  const Contact on = contact(settled(cornered, attitude), Vec3::Zero(), 0);
  REQUIRE(attitude.rolls.size() == 2);
  CHECK(attitude.rolls[0].over.size() == 1);
  CHECK(attitude.rolls[1].over.size() == 2);
  CHECK(on.patch.size() == 4);
  CHECK(on.margin > 0.4);
}

TEST_CASE("a box in balance on an edge or a corner is let fall, and says so", "[settle]") {
  const RawMesh cube = box({2, 2, 2}, {-1, -1, -1});
  for (const Vec3& down : {Vec3(0, 1, 1), Vec3(1, 1, 1)}) {
    const Eigen::Matrix3d to_down = Eigen::Quaterniond::FromTwoVectors(down, -Vec3::UnitY()).toRotationMatrix();
    const Attitude attitude = settle(rotated(cube, to_down).vertices, Vec3::Zero());
    CHECK(attitude.balanced);
    CHECK(attitude.least_angle == Approx(std::acos(1 / down.norm())).epsilon(1e-13));
    CHECK(attitude.angle >= attitude.least_angle - 1e-14);
  }
}

TEST_CASE("random convex bodies come to rest with the barycentre over the patch and no vertex below it", "[settle]") {
  std::mt19937 random(5);
  for (int body = 0; body < 40; ++body) {
    const RawMesh mesh = convex_polyhedron(random, 30, 50);
    Attitude attitude;
    const std::vector<Vec3> vertices = settled(mesh, attitude);
    const Vec3 b = attitude.rotation * centre(mesh);
    const Contact on = contact(vertices, b, 0);
    CHECK((attitude.rotation.transpose() * attitude.rotation - Eigen::Matrix3d::Identity()).norm() < 1e-14);
    CHECK(on.patch.size() >= 3);
    CHECK(on.margin > 0);
    double before = 0;
    for (const Vec3& v : mesh.vertices) before = std::max(before, centre(mesh).y() - v.y());
    CHECK(b.y() - on.ground <= before * (1 + 1e-14));
    // Settled once more, it stays.
    CHECK(settle(vertices, b).angle < 1e-13);
  }
}

TEST_CASE("a fine ball rolls a little way only", "[settle]") {
  Attitude attitude;
  settled(icosphere(5), attitude);
  CHECK(attitude.angle < 0.05);
}

TEST_CASE("a barycentre outside the hull comes down to the ground, unless it is right above", "[settle]") {
  const RawMesh mesh = box({2, 2, 2}, {-1, -1, -1});
  CHECK(settle(mesh.vertices, {0, 3, 0}).angle == 0);
  for (const Vec3& b : {Vec3(0, -3, 0), Vec3(5, 0, 0), Vec3(0, 0, 1.0001)}) {
    try {
      settle(mesh.vertices, b);
      FAIL("it stands");
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::cannot_stand);
    }
  }
}

TEST_CASE("the contact patch is the hull of the points within the tolerance", "[settle]") {
  const std::vector<Vec3> points = {{0, 0, 0}, {4, 0, 0}, {4, 0, 4}, {0, 0.1, 4}, {2, 0, 0}, {2, 0.05, 2}, {2, 5, 2}};
  const Vec3 b(2, 2, 2);
  const Contact none = contact(points, b, 0), some = contact(points, b, 0.06), all = contact(points, b, 0.1);
  CHECK(none.support.size() == 4);
  CHECK(none.patch.size() == 3);
  CHECK(std::abs(none.margin) < 1e-14); // on the long side
  CHECK(some.support.size() == 5);
  CHECK(some.patch.size() == 3);
  CHECK(all.support.size() == 6);
  CHECK(all.patch.size() == 4);
  CHECK(all.margin == Approx(2).epsilon(1e-14));
  CHECK(contact(points, {10, 2, 2}, 0.1).margin == Approx(-6).epsilon(1e-14));
}

TEST_CASE("a body rolls from facet to facet over edges that stay where they are, and each roll lowers it", "[settle]") {
  std::mt19937 random(17);
  int several = 0, apart = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const RawMesh mesh = on_a_facet(random, 5 + trial % 12);
    const Vec3 b = centre(mesh);
    const Attitude attitude = settle(mesh.vertices, b);
    const auto& rolls = attitude.rolls;
    if (rolls.empty() || !std::all_of(rolls.begin(), rolls.end(), [](const Roll& r) { return r.over.size() == 2; }))
      continue;
    // Turned about each edge as it lies, by the angle of the roll, to the side where b comes down.
    std::vector<Vec3> at = mesh.vertices;
    Vec3 barycentre = b;
    for (const Roll& roll : rolls) {
      const Vec3 p = at[roll.over[0]], axis = (at[roll.over[1]] - p).normalized();
      double ground = p.y();
      for (const Vec3& v : at) ground = std::min(ground, v.y());
      CHECK(std::abs(axis.y()) < 1e-9);
      CHECK(p.y() == Approx(ground).margin(1e-9));
      CHECK(barycentre.y() - ground == Approx(roll.before).margin(1e-9));
      const double falls = axis.cross(barycentre - p).y(); // per angle
      const Eigen::Matrix3d t = turn(falls < 0 ? roll.angle : -roll.angle, axis);
      for (Vec3& v : at) v = p + t * (v - p);
      barycentre = p + t * (barycentre - p);
      CHECK(barycentre.y() - p.y() == Approx(roll.after).margin(1e-9));
      CHECK(roll.after < roll.before);
    }
    const Contact on = contact(at, barycentre, 0);
    CHECK(on.margin > 0);
    CHECK(on.patch.size() >= 3);
    double off = 0;
    for (std::size_t i = 0; i < at.size(); ++i)
      off = std::max(off, (attitude.rotation * (mesh.vertices[i] - b) - (at[i] - barycentre)).norm());
    CHECK(off < 1e-9);
    several += rolls.size() > 1;
    apart += std::abs(attitude.heading) > 0.02;
  }
  CHECK(several > 10);
  CHECK(apart > 5);
}

TEST_CASE("rolling in one go is what small turns come to, where the least turn is another", "[settle]") {
  std::mt19937 random(23);
  int apart = 0;
  for (int trial = 0; trial < 400 && apart < 4; ++trial) {
    const RawMesh mesh = on_a_facet(random, 8);
    const Vec3 b = centre(mesh);
    const Attitude attitude = settle(mesh.vertices, b);
    if (!(std::abs(attitude.heading) > 0.1)) continue;
    ++apart;
    CHECK(angle_between(attitude.rotation, rolled_slowly(mesh.vertices, b, 2e-4)) < 0.02);
  }
  CHECK(apart == 4);
  // A die loaded in a corner, let go on an edge next to the opposite one.
  const RawMesh die = rotated(box({2, 2, 2}, {-1, -1, -1}), turn(0.6, {1, 0.3, 0.2}));
  const Vec3 b = turn(0.6, {1, 0.3, 0.2}) * Vec3(0.5, 0.6, -0.4);
  const Attitude attitude = settle(die.vertices, b);
  CHECK(attitude.rolls.size() == 2);
  CHECK(angle_between(attitude.rotation, rolled_slowly(die.vertices, b, 2e-4)) < 0.01);
  CHECK(std::abs(attitude.heading) > 0.03);
}

TEST_CASE("smooth bodies of many facets and pits of equal height come to rest, lower and lower", "[settle]") {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> in(-1, 1);
  std::vector<std::vector<Vec3>> bodies;
  for (const double noise : {0.0, 1e-10, 3e-10, 1e-9, 1e-6}) {
    std::vector<Vec3> ball = icosphere(3).vertices, drum;
    for (Vec3& v : ball) v *= 1 + noise * in(random);
    for (int i = 0; i < 256; ++i)
      for (const double x : {-0.5, 0.5})
        drum.emplace_back(x + noise * in(random), std::cos(i * pi / 128) + noise * in(random), std::sin(i * pi / 128));
    std::vector<Vec3> egg = ball;
    for (Vec3& v : egg) v.x() *= 1.7;
    bodies.insert(bodies.end(), {ball, drum, egg});
  }
  for (const std::vector<Vec3>& body : bodies) {
    const Eigen::Matrix3d start = turn(0.5, {in(random), in(random), in(random)});
    std::vector<Vec3> vertices;
    for (const Vec3& v : body) vertices.emplace_back(start * v);
    const Vec3 b(0.01 * in(random), 0.01 * in(random), 0.01 * in(random));
    const Attitude attitude = settle(vertices, b);
    for (const Roll& roll : attitude.rolls) CHECK(roll.after <= roll.before * (1 + 1e-15));
    CHECK(attitude.rolls.size() < 4 * vertices.size());
    for (Vec3& v : vertices) v = attitude.rotation * v;
    CHECK(contact(vertices, attitude.rotation * b, 0).margin > -1e-9);
  }
}
