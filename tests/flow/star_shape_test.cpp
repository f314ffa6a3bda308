#include "host/flow/star_shape.hpp"

#include "host/error.hpp"
#include "host/flow/flow_map.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

StarShapeTime find(const RawMesh& mesh, const Vec3& origin, double tolerance) {
  const auto backend = make_cpu_backend();
  Monitor monitor;
  return star_shape_time(mesh.vertices, mesh.faces, origin, tolerance, *backend, monitor);
}

} // namespace

TEST_CASE("a body that is star-shaped as it is needs no time", "[star_shape]") {
  for (const RawMesh& mesh : {test::icosphere(3), box({1, 2, 3}, {-0.5, -1, -1})}) {
    const StarShapeTime time = find(mesh, Vec3::Zero(), 1e-6);
    CHECK(time.lower == 0);
    CHECK(time.upper == 1e-6);
  }
}

TEST_CASE("seen from outside, a convex body is star-shaped once it reaches the origin", "[star_shape]") {
  const RawMesh mesh = box({1, 2, 2}, {1, -1, -1});
  const StarShapeTime time = find(mesh, Vec3::Zero(), 1e-7);
  CHECK(time.lower == Approx(1).epsilon(1e-12));
  CHECK(time.upper == Approx(1 + 1e-7).epsilon(1e-12));
  // Off to the side of an edge: the distance is sqrt(1 + 1/4).
  const StarShapeTime oblique = find(mesh, {0, 1.5, 0}, 1e-7);
  CHECK(oblique.lower <= std::sqrt(1.25) + 1e-12);
  CHECK(oblique.upper >= std::sqrt(1.25));
  CHECK(oblique.upper - oblique.lower < 1.1e-7);
}

TEST_CASE("across a gap between two boxes the time is sqrt 2 by the closed form", "[star_shape]") {
  // From (2, 0, 0) in the right box: of the left one's upper edge, normals (cos a, sin a), the ball touches the right
  // one's edge at 1 / cos a, and sees the origin from behind below 3 cos a - sin a. Both are sqrt 2 at 45 degrees.
  const RawMesh mesh = together(box({2, 2, 2}, {1, -1, -1}), box({2, 2, 2}, {-3, -1, -1}));
  const StarShapeTime time = find(mesh, {2, 0, 0}, 1e-3);
  CAPTURE(time.regions, time.queries);
  CHECK(time.lower <= std::sqrt(2) + 1e-12);
  CHECK(time.upper >= std::sqrt(2) - 1e-12);
  CHECK(time.upper - time.lower < 1.1e-3);
  CHECK(time.normal.x() == Approx(std::sqrt(0.5)).margin(1e-3));
  CHECK((time.point + time.lower * time.normal - time.place).norm() < 1e-12);
}

TEST_CASE("where the supremum is met all along an edge the search is given up with bounds that hold", "[star_shape]") {
  const RawMesh mesh = together(box({2, 2, 2}, {1, -1, -1}), box({2, 2, 2}, {-3, -1, -1}));
  const StarShapeTime time = find(mesh, {2, 0, 0}, 1e-8);
  CAPTURE(time.lower, time.upper, time.regions);
  CHECK(time.given_up);
  CHECK(time.lower <= std::sqrt(2) + 1e-12);
  CHECK(time.upper >= std::sqrt(2));
  CHECK(time.upper - time.lower > 1e-8);
  CHECK(time.upper - time.lower < 1e-3);
  // An expansion takes the upper bound, and says so.
  const auto backend = make_cpu_backend();
  Monitor monitor;
  ExpandSurfaceOptions options;
  options.lmax = 2;
  options.grid_degree = 32;
  options.origin = {2, 0, 0};
  const LevelSetExpansion found = expand_level_set(mesh, 0, options, *backend, monitor);
  CHECK(found.time >= std::sqrt(2));
  CHECK(found.time < std::sqrt(2) + 1e-2);
  CHECK(found.star.given_up == !found.notes.empty());
  CHECK(found.level_set.least_slope > 0);
}

TEST_CASE("star-shape times without faces, with an origin not finite or too fine a tolerance are refused",
          "[star_shape]") {
  RawMesh mesh = box({1, 1, 1});
  CHECK_THROWS_AS(find(mesh, {NAN, 0, 0}, 1e-6), Error);
  CHECK_THROWS_AS(find(mesh, Vec3::Zero(), 1e-12), Error);
  CHECK_THROWS_AS(find(mesh, Vec3::Zero(), NAN), Error);
  mesh.faces.clear();
  CHECK_THROWS_AS(find(mesh, Vec3::Zero(), 1e-6), Error);
}

TEST_CASE("the inflated benchmark is star-shaped from 0.241954 on, about its centre of mass from 0.241827",
          "[star_shape][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const StarShapeTime time = find(cow->mesh(), Vec3::Zero(), 1e-7);
  CHECK(time.lower == Approx(0.2419544).margin(1e-7));
  CHECK(time.upper == Approx(0.2419545).margin(1e-7));
  CHECK((time.place.cwiseAbs() - Vec3(0.1146, 0.3829, 0.0313)).norm() < 1e-4);
  const StarShapeTime centred =
      find(cow->mesh(), {-0.0909084661394062, 0.0449178604782050975, -0.0000825839046777753}, 1e-6);
  CHECK(centred.lower >= 0.241826);
  CHECK(centred.upper < 0.24583);
}
