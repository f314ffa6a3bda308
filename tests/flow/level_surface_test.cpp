#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/flow/level_surface.hpp"
#include "host/mesh/audit.hpp"
#include "host/mesh/geometry.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

constexpr double pi = std::numbers::pi;

struct Level {
  TriangleSurface surface;
  LevelSurfaceReport report;
  Audit audit;
};

Level level_of(const RawMesh& mesh, double level, int cells) {
  const auto backend = make_cpu_backend();
  const auto field = backend->distance_field(mesh.vertices, mesh.faces);
  const Box box = bounding_box(mesh.vertices, mesh.faces);
  Level found;
  found.surface = level_surface(*field, box.min, box.max, level, cells, silent_monitor(), &found.report);
  RawMesh raw;
  raw.vertices = found.surface.vertices;
  raw.faces = found.surface.faces;
  found.audit = audit(raw);
  return found;
}

void check_manifold(const Level& found) {
  CHECK(found.audit.closed);
  CHECK(found.audit.consistently_oriented);
  CHECK(found.audit.edge_manifold);
  CHECK(found.audit.vertex_manifold);
  CHECK(found.audit.outward);
}

} // namespace

TEST_CASE("an inflated box has the volume and area of Steiner's formula, to second order", "[inflate]") {
  const Vec3 sides(1, 2, 3);
  const double v = sides.prod(), edges = sides.sum();
  const double a = 2 * (sides.x() * sides.y() + sides.y() * sides.z() + sides.z() * sides.x());
  for (const double t : {0.5, 1.0, 4.0}) { // no less than some cells, or they are no judge of the order
    const double volume = v + a * t + pi * edges * t * t + 4. / 3 * pi * t * t * t;
    const double area = a + 2 * pi * edges * t + 4 * pi * t * t;
    const Level coarse = level_of(box(sides), t, 32), fine = level_of(box(sides), t, 64);
    for (const Level* found : {&coarse, &fine}) {
      check_manifold(*found);
      CHECK(found->audit.components == 1);
      CHECK(found->audit.genus.value_or(-1) == 0);
      CHECK(found->report.largest_residual < 1e-12 * sides.norm());
    }
    const double error = volume - *fine.audit.volume, coarser = volume - *coarse.audit.volume;
    INFO(t << ": volume off by " << error / volume << " and " << coarser / volume << ", area by "
           << fine.audit.area / area - 1);
    CHECK(error > 0); // chords of a convex surface
    CHECK(error < 1.6e-3 * volume);
    CHECK(std::log2(coarser / error) == Approx(2).margin(0.25));
    CHECK(std::abs(fine.audit.area - area) < 1e-3 * area);
  }
}

TEST_CASE("the level set of a ball is the larger ball, with its normals", "[inflate]") {
  const RawMesh ball = icosphere(4);
  const Level found = level_of(ball, 0.5, 40);
  check_manifold(found);
  double farthest = 0, least = 1;
  for (std::size_t v = 0; v < found.surface.vertices.size(); ++v) {
    const Vec3& p = found.surface.vertices[v];
    farthest = std::max(farthest, std::abs(p.norm() - 1.5));
    least = std::min(least, p.normalized().dot(found.surface.normals[v]));
  }
  CHECK(farthest < 5e-3); // the icosphere's sagitta
  CHECK(least > 0.995);
}

TEST_CASE("inflating changes the topology as the body's does", "[inflate]") {
  // The tube has radius 1, the hole 2.
  const RawMesh ring = torus(48, 24);
  const Level thin = level_of(ring, 0.5, 64), closed = level_of(ring, 2.5, 64);
  check_manifold(thin);
  check_manifold(closed);
  CHECK(thin.audit.genus.value_or(-1) == 1);
  CHECK(closed.audit.genus.value_or(-1) == 0);
  const Level hollow = level_of(shell_with_cavity(), 0.02, 96);
  check_manifold(hollow);
  CHECK(hollow.audit.components == 2);
  CHECK(hollow.audit.cavities == 1);
}

TEST_CASE("errors of volume and area are at least the true ones, on coarse cubes too", "[inflate]") {
  struct Case {
    Vec3 sides;
    double level;
    int cells;
  };
  for (const Case& c : {Case{{1, 2, 3}, 0.01, 4}, Case{{1, 2, 3}, 0.1, 16}, Case{{1, 2, 3}, 1, 32},
                        Case{{1, 1, 0.01}, 0.02, 16}, Case{{0.03, 0.02, 3}, 0.05, 32}, Case{{1, 2, 3}, 0.001, 128}}) {
    CAPTURE(c.sides.transpose(), c.level, c.cells);
    // Turned, so that no plate lies along the cubes.
    const RawMesh body = rotated(box(c.sides), Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix());
    const double t = c.level, edges = c.sides.sum();
    const double a = 2 * (c.sides.x() * c.sides.y() + c.sides.y() * c.sides.z() + c.sides.z() * c.sides.x());
    const double volume = c.sides.prod() + a * t + pi * edges * t * t + 4. / 3 * pi * t * t * t;
    const double area = a + 2 * pi * edges * t + 4 * pi * t * t;
    const Level found = level_of(body, t, c.cells);
    const auto backend = make_cpu_backend();
    const auto field = backend->distance_field(body.vertices, body.faces);
    const Box bounds = bounding_box(body.vertices, body.faces);
    const LevelSurfaceError error =
        level_surface_error(*field, bounds.min, bounds.max, t, c.cells, found.surface, found.report, silent_monitor());
    CAPTURE(volume, error.volume, error.volume_error, area, error.area, error.area_error, found.report.missed);
    CHECK(error.volume == Approx(found.audit.volume.value_or(0)).epsilon(1e-9));
    CHECK(std::abs(error.volume - volume) <= error.volume_error);
    CHECK(std::abs(error.area - area) <= error.area_error);
  }
}

TEST_CASE("level sets that mean nothing are refused", "[inflate]") {
  const RawMesh mesh = box(Vec3(1, 1, 1));
  for (const double level :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    CHECK_THROWS_AS(level_of(mesh, level, 16), Error);
  for (const int cells : {-1, 0, 3, 1025}) CHECK_THROWS_AS(level_of(mesh, 0.5, cells), Error);
}
