#include "host/physics/settle.hpp"

#include "host/error.hpp"
#include "host/mesh/geometry.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

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

} // namespace

TEST_CASE("a box that stands flat stays as it is", "[settle]") {
  const RawMesh mesh = box({3, 2, 1}, {7, -4, 2});
  const Attitude attitude = settle(mesh.vertices, centre(mesh));
  CHECK(attitude.rotation.isIdentity(0));
  CHECK(attitude.angle == 0);
  CHECK(attitude.steps == 0);
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
  CHECK(attitude.steps == 2);
  CHECK(on.patch.size() == 4);
  CHECK(on.margin > 0.4);
}

TEST_CASE("a box in balance on an edge or a corner is let fall, and says so", "[settle]") {
  const RawMesh cube = box({2, 2, 2}, {-1, -1, -1});
  for (const Vec3& down : {Vec3(0, 1, 1), Vec3(1, 1, 1)}) {
    const Eigen::Matrix3d to_down = Eigen::Quaterniond::FromTwoVectors(down, -Vec3::UnitY()).toRotationMatrix();
    const Attitude attitude = settle(rotated(cube, to_down).vertices, Vec3::Zero());
    CHECK(attitude.balanced);
    CHECK(attitude.angle == Approx(std::acos(1 / down.norm())).epsilon(1e-13));
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
