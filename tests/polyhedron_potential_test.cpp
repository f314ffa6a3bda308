#include "tests/support/meshes.hpp"
#include "tests/support/polyhedron_potential.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {
constexpr long double pi = std::numbers::pi_v<long double>;
}

TEST_CASE("a box far away attracts like its mass with its second and fourth moments", "[polyhedron]") {
  const RawMesh cube = box(Vec3(1, 1, 1), Vec3(-0.5, -0.5, -0.5));
  for (const LongVec3& at : {LongVec3(40, 0, 0), LongVec3(20, -30, 10), LongVec3(1, 2, 39)}) {
    // A cube has no second moments; degree 4: V = 1/r + c4 (x^4 + y^4 + z^4 - 3/5 r^4) / r^9, c4 = -7/192.
    const long double r = at.norm();
    const long double quartic = at.array().pow(4).sum() - 0.6L * r * r * r * r;
    const long double expected = 1 / r - 7.0L / 192 * quartic / std::pow(r, 9.0L);
    // Degree 6 adds (d/r)^6, d the half diagonal.
    CHECK(std::fabs(polyhedron_gravity(cube, at).potential * r - expected * r) <= 0.1L * std::pow(0.87L / r, 6.0L));
  }
}

TEST_CASE("a fine ball attracts like its mass outside, and as a ball does inside", "[polyhedron]") {
  const RawMesh ball = icosphere(4);
  long double volume = 0;
  for (const auto& f : ball.faces)
    volume += ball.vertices[f[0]].dot(ball.vertices[f[1]].cross(ball.vertices[f[2]])) / 6;
  const PolyhedronGravity outside = polyhedron_gravity(ball, LongVec3(0, 3, 4));
  CHECK(std::fabs(outside.potential * 5 / volume - 1) <= 1e-7L);
  CHECK((outside.acceleration * 25 / volume + LongVec3(0, 0.6L, 0.8L)).norm() <= 1e-7L);
  CHECK(std::fabs(outside.laplacian) <= 1e-15L);
  const PolyhedronGravity inside = polyhedron_gravity(ball, LongVec3(0.3L, 0, 0.4L));
  CHECK(std::fabs(inside.potential / (2 * pi * (1 - 0.25L / 3)) - 1) <= 5e-3L); // the mesh's sagitta
  CHECK(std::fabs(inside.laplacian + 4 * pi) <= 1e-14L);
}

TEST_CASE("the acceleration is the gradient of the potential, inside and outside", "[polyhedron]") {
  const RawMesh body = box(Vec3(1, 2, 3), Vec3(-0.2, -1.1, -0.7));
  for (const LongVec3& at : {LongVec3(0.1L, 0.2L, 0.3L), LongVec3(2, -1, 4)}) {
    const PolyhedronGravity here = polyhedron_gravity(body, at);
    for (int c = 0; c < 3; ++c) {
      constexpr long double h = 1e-4L;
      LongVec3 step = LongVec3::Zero();
      step[c] = h;
      const auto u = [&](int k) { return polyhedron_gravity(body, at + k * step).potential; };
      const long double slope = (8 * (u(1) - u(-1)) - (u(2) - u(-2))) / (12 * h);
      CHECK(std::fabs(slope - here.acceleration[c]) <= 1e-13L);
    }
  }
}
