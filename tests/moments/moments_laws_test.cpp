// Laws that moments obey whatever the body: scale, rotation, translation, additivity, flips, order, subdivision, bounds.
#include "host/mesh/geometry.hpp"
#include "host/mesh/subdivide.hpp"
#include "host/plan/moments.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

struct Depth {
  int lmax;
  double figure;
};

/// Calls `law` with bodies of every family to degree 40, and some to degree 200: rounding of the coordinates enters a
/// degree l with the factor l, so each has its figure.
void for_bodies(double at_40, double at_200, const std::function<void(const RawMesh&, Depth)>& law) {
  std::mt19937 random(11);
  for (const RawMesh& mesh :
       {box({1, 2, 3}, {-0.4, -0.9, -1.7}), tetrahedron({3, -1, 2}, {-4, 2, 1}, {0, 5, -3}, {-1, -2, -4}),
        convex_polyhedron(random, 15, 50), torus(12, 7), two_shells(), shell_with_cavity()})
    law(mesh, {40, at_40});
  law(two_shells(), {200, at_200});
  law(icosphere(2), {200, at_200});
}

/// Q_lm turned into what a body scaled and turned about z has: times `factor` exp(i m angle).
Multipoles turned(Multipoles q, double factor, double angle) {
  for (int l = 0; l <= q.lmax; ++l)
    for (int m = 0; m <= l; ++m) q(l, m) *= factor * std::polar(1.0, m * angle);
  return q;
}

const Eigen::Matrix3d tilt = Eigen::AngleAxisd(1.1, Vec3(2, -1, 3).normalized()).toRotationMatrix();

} // namespace

TEST_CASE("scaling a body by s multiplies its moments by s^(l+3)", "[moments][laws]") {
  Paths paths;
  for_bodies(4e-14, 1e-13, [&](const RawMesh& mesh, Depth depth) {
    for (const double s : {0.5, 3.7, 1e-20, 1e30}) {
      const RawMesh larger = scaled(mesh, Vec3::Constant(s));
      const MomentProblem before = moment_problem(mesh, depth.lmax), after = moment_problem(larger, depth.lmax);
      paths.each([&](Backend& backend) {
        const Multipoles p = moments(backend, before);
        Multipoles q = moments(backend, after);
        // What is stored is divided by R^l already; R scales with the body.
        check_at_most(std::abs(q.reference_radius / (s * p.reference_radius) - 1), 4e-16, "radius");
        check_close(turned(q, 1 / (s * s * s), 0), p, before, depth.figure);
      });
    }
  });
}

TEST_CASE("the reference radius changes moments by its powers only", "[moments][laws]") {
  Paths paths;
  for_bodies(1.6e-14, 1e-13, [&](const RawMesh& mesh, Depth depth) {
    const MomentProblem tight = moment_problem(mesh, depth.lmax);
    MomentProblem wide = tight;
    wide.reference_radius = 1.5 * tight.reference_radius;
    paths.each([&](Backend& backend) {
      const Multipoles p = moments(backend, tight);
      Multipoles q = moments(backend, wide);
      for (int l = 0; l <= q.lmax; ++l)
        for (int m = 0; m <= l; ++m) q(l, m) *= std::pow(1.5, l);
      check_close(q, p, tight, depth.figure);
    });
  });
}

TEST_CASE("density multiplies all moments", "[moments][laws]") {
  Paths paths;
  const RawMesh mesh = two_shells();
  const MomentProblem one = moment_problem(mesh, 40);
  MomentProblem eight = one;
  eight.density = 8;
  paths.each([&](Backend& backend) { CHECK(same_bits(turned(moments(backend, one), 8, 0), moments(backend, eight))); });
}

TEST_CASE("turning a body about z multiplies order m by exp(i m angle)", "[moments][laws]") {
  Paths paths;
  for_bodies(2e-14, 1.2e-13, [&](const RawMesh& mesh, Depth depth) {
    for (const double angle : {0.3, 2.0, -1.4}) {
      const RawMesh after = rotated(mesh, Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix());
      const MomentProblem problem = moment_problem(mesh, depth.lmax);
      MomentProblem turned_problem = problem;
      turned_problem.vertices = after.vertices;
      paths.each([&](Backend& backend) {
        check_close(moments(backend, turned_problem), turned(moments(backend, problem), 1, angle), problem,
                    depth.figure);
      });
    }
  });
}

TEST_CASE("any rotation keeps the norm of every degree", "[moments][laws]") {
  Paths paths;
  for_bodies(8e-14, 3e-13, [&](const RawMesh& mesh, Depth depth) {
    const RawMesh after = rotated(mesh, tilt);
    const MomentProblem problem = moment_problem(mesh, depth.lmax);
    MomentProblem turned_problem = problem;
    turned_problem.vertices = after.vertices;
    const auto bound = plan::degree_bound(problem);
    paths.each([&](Backend& backend) {
      const Multipoles p = moments(backend, problem), q = moments(backend, turned_problem);
      double worst = 0;
      for (int l = 0; l <= depth.lmax; ++l)
        worst = std::max(worst, std::abs(degree_norm(p, l) - degree_norm(q, l)) /
                                    std::max(degree_norm(p, l), 1e-3 * bound[std::size_t(l)]));
      check_at_most(worst, depth.figure, fmt::format("lmax {}", depth.lmax));
    });
  });
}

TEST_CASE("a body moved together with its origin keeps its moments", "[moments][laws]") {
  Paths paths;
  for_bodies(2.5e-14, 2.4e-13, [&](const RawMesh& mesh, Depth depth) {
    const Vec3 shift(0.7, -1.3, 2.9);
    const RawMesh after = translated(mesh, shift);
    const MomentProblem problem = moment_problem(mesh, depth.lmax, {0.1, 0.2, 0.3});
    MomentProblem moved = problem;
    moved.vertices = after.vertices;
    moved.origin += shift;
    paths.each([&](Backend& backend) {
      check_close(moments(backend, moved), moments(backend, problem), problem, depth.figure);
    });
  });
}

TEST_CASE("moments of two shells add", "[moments][laws]") {
  Paths paths;
  const RawMesh one = torus(9, 7), two = translated(rotated(torus(7, 5, 1, 0.4), tilt), {5, -1, 2});
  const RawMesh both = together(one, two);
  for (const int lmax : {40, 200}) {
    const MomentProblem whole = moment_problem(both, lmax);
    MomentProblem first = whole, second = whole;
    first.faces = one.faces;
    second.vertices = two.vertices;
    second.faces = two.faces;
    paths.each([&](Backend& backend) {
      Multipoles sum = moments(backend, first);
      const Multipoles q = moments(backend, second);
      for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += q.values[i];
      check_close(moments(backend, whole), sum, whole, 1.5e-15);
    });
  }
}

TEST_CASE("flipping all faces negates all moments", "[moments][laws]") {
  Paths paths;
  for_bodies(2e-15, 1.6e-14, [&](const RawMesh& mesh, Depth depth) {
    const RawMesh after = flipped(mesh);
    const MomentProblem problem = moment_problem(mesh, depth.lmax), inside_out = moment_problem(after, depth.lmax);
    paths.each([&](Backend& backend) {
      check_close(turned(moments(backend, inside_out), -1, 0), moments(backend, problem), problem, depth.figure);
    });
  });
}

TEST_CASE("the order of vertices, faces and corners does not matter", "[moments][laws]") {
  Paths paths;
  for_bodies(6e-15, 6e-14, [&](const RawMesh& mesh, Depth depth) {
    const RawMesh after = shuffled(mesh, 3);
    const MomentProblem problem = moment_problem(mesh, depth.lmax), other = moment_problem(after, depth.lmax);
    paths.each([&](Backend& backend) {
      check_close(moments(backend, other), moments(backend, problem), problem, depth.figure);
    });
  });
}

TEST_CASE("cutting triangles at the midpoints of their edges does not matter", "[moments][laws]") {
  Paths paths;
  for_bodies(8e-15, 7e-14, [&](const RawMesh& mesh, Depth depth) {
    const RawMesh fine = split_midpoint(mesh);
    const MomentProblem problem = moment_problem(mesh, depth.lmax), finer = moment_problem(fine, depth.lmax);
    paths.each([&](Backend& backend) {
      check_close(moments(backend, finer), moments(backend, problem), problem, depth.figure);
    });
  });
}

TEST_CASE("about the centre of mass there is no dipole, and the monopole is the mass", "[moments][laws]") {
  Paths paths;
  for_bodies(1e-15, 1e-15, [&](const RawMesh& mesh, Depth depth) {
    const Vec3 centre = centre_of_mass(mesh.vertices, mesh.faces);
    MomentProblem problem = moment_problem(mesh, 2, centre);
    problem.density = 3;
    const double mass = 3 * volume(mesh.vertices, mesh.faces);
    paths.each([&](Backend& backend) {
      const Multipoles q = moments(backend, problem);
      check_at_most(std::abs(q(0, 0) * std::sqrt(4 * std::acos(-1)) / mass - 1.0), depth.figure, "monopole");
      check_at_most(degree_norm(q, 1) / mass, 1.5e-16, "dipole");
    });
  });
}

TEST_CASE("no moment exceeds the bound of its degree", "[moments][laws]") {
  Paths paths;
  for_bodies(1e-15, 1e-15, [&](const RawMesh& mesh, Depth depth) {
    const MomentProblem problem = moment_problem(mesh, depth.lmax);
    const auto bound = plan::degree_bound(problem);
    REQUIRE(bound.size() == std::size_t(depth.lmax) + 1);
    paths.each([&](Backend& backend) {
      const Multipoles q = moments(backend, problem);
      for (int l = 0; l <= depth.lmax; ++l)
        for (int m = 0; m <= l; ++m) REQUIRE(std::abs(q(l, m)) <= bound[std::size_t(l)] * (1 + 1e-12));
    });
  });
}

TEST_CASE("on a star-shaped body the bound of degree 0 is attained", "[moments][laws]") {
  const RawMesh mesh = icosphere(1);
  const MomentProblem problem = moment_problem(mesh, 3);
  const double mass = volume(mesh.vertices, mesh.faces);
  CHECK(plan::degree_bound(problem)[0] == Approx(mass / std::sqrt(4 * std::acos(-1))).epsilon(1e-14));
}
