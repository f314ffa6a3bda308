#include "host/mesh/convex_hull.hpp"

#include "host/flow/flow_map.hpp"
#include "host/geometry/orientation.hpp"
#include "host/mesh/geometry.hpp"
#include "host/sphere_grid.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

constexpr double pi = std::numbers::pi;

// Every edge once each way, and no point in front of a face.
void check_hull(const std::vector<Vec3>& points, const std::vector<Face>& hull) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::size_t in_front = 0;
  for (const Face& f : hull) {
    for (std::size_t c = 0; c < 3; ++c) ++edges[{f[c], f[(c + 1) % 3]}];
    for (const Vec3& p : points) in_front += side_of_plane(points[f[0]], points[f[1]], points[f[2]], p) < 0;
  }
  CHECK(in_front == 0);
  for (const auto& [edge, count] : edges) REQUIRE((count == 1 && edges.count({edge.second, edge.first}) == 1));
  const std::size_t corners = hull.size() / 2 + 2; // Euler
  std::vector<bool> used(points.size(), false);
  for (const Face& f : hull)
    for (const std::uint32_t v : f) used[v] = true;
  CHECK(std::size_t(std::count(used.begin(), used.end(), true)) == corners);
}

double sum_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum;
}

// Midpoint rule on rings of equal height: the integrand jumps between the normal cones.
double monopole_by_grid(const std::vector<Vec3>& vertices, int rings) {
  double sum = 0;
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < 2 * rings; ++j) {
      const double z = -1 + (2 * i + 1.0) / rings, phi = (j + 0.5) * pi / rings, s = std::sqrt(1 - z * z);
      const Vec3 n(s * std::cos(phi), s * std::sin(phi), z);
      sum += std::max_element(vertices.begin(), vertices.end(), [&](const Vec3& a, const Vec3& b) {
               return a.dot(n) < b.dot(n);
             })->norm();
    }
  return sum * 4 * pi / (2.0 * rings * rings) / std::sqrt(4 * pi);
}

} // namespace

TEST_CASE("the hull of random points holds them all and is closed", "[hull]") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(-1, 1);
  for (const std::size_t count : {4U, 5U, 20U, 300U}) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) points.emplace_back(in(random), in(random), in(random));
    const auto hull = convex_hull(points);
    check_hull(points, hull);
    CHECK(sum_of(normal_cone_solid_angles(points, hull)) == Approx(4 * pi).epsilon(1e-13));
  }
}

TEST_CASE("points in one plane, on one line and alike make no hull; those on a grid make a box", "[hull]") {
  CHECK(convex_hull({}).empty());
  CHECK(convex_hull(std::vector<Vec3>(9, Vec3(1, 2, 3))).empty());
  std::vector<Vec3> line, plane, grid;
  for (int i = 0; i < 4; ++i) {
    line.emplace_back(0.1 * i, 0.3 * i, -0.7 * i);
    for (int j = 0; j < 4; ++j) {
      plane.emplace_back(i, j, 5);
      for (int k = 0; k < 4; ++k) grid.emplace_back(i, j, k);
    }
  }
  line = {{0, 0, 0}, {1, 3, -7}, {2, 6, -14}};
  CHECK(convex_hull(line).empty());
  CHECK(convex_hull(plane).empty());
  std::vector<Vec3> doubled = grid;
  doubled.insert(doubled.end(), grid.begin(), grid.end());
  for (const auto& points : {grid, doubled}) {
    const auto hull = convex_hull(points);
    std::size_t in_front = 0;
    for (const Face& f : hull)
      for (const Vec3& p : points) in_front += side_of_plane(points[f[0]], points[f[1]], points[f[2]], p) < 0;
    CHECK(in_front == 0);
    CHECK(volume(points, hull) == Approx(27).epsilon(1e-14));
    const auto solid = normal_cone_solid_angles(points, hull);
    // An eighth of the sphere at each corner of the box, nothing elsewhere.
    for (std::size_t i = 0; i < points.size(); ++i) CHECK((solid[i] < 1e-14 || std::abs(solid[i] - pi / 2) < 1e-14));
    CHECK(sum_of(solid) == Approx(4 * pi).epsilon(1e-14));
  }
}

TEST_CASE("the hull is exact where facets are a last bit apart", "[hull]") {
  // A sphere's points moved by single bits, far from the origin and thin.
  for (const double squeeze : {1.0, 1e-14}) {
    std::vector<Vec3> points = test::icosphere(3).vertices;
    for (Vec3& p : points) p = Vec3(p.x() + 1e3, p.y() * squeeze, p.z() - 1e3);
    const auto hull = convex_hull(points);
    REQUIRE(!hull.empty());
    check_hull(points, hull);
  }
}

TEST_CASE("at large times the flow's monopole is that of the corners, each over its normal cone", "[hull][flow]") {
  const RawMesh cube = box({2, 2, 2}, {-1, -1, -1});
  // Every corner is sqrt 3 away.
  CHECK(monopole_at_large_times(cube.vertices, Vec3::Zero()) == Approx(std::sqrt(4 * pi * 3)).epsilon(1e-14));
  std::mt19937 random(8);
  const RawMesh body = convex_polyhedron(random, 20, 40);
  const double exact = monopole_at_large_times(body.vertices, Vec3::Zero());
  CHECK(monopole_by_grid(body.vertices, 400) == Approx(exact).epsilon(3e-4));
  CHECK_THROWS_WITH(monopole_at_large_times(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, Vec3::Zero()),
                    Catch::Contains("one plane"));
}

TEST_CASE("at large times the benchmark's monopole is 1.7151368", "[hull][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const double exact = monopole_at_large_times(cow->vertices(), Vec3::Zero());
  CHECK(exact == Approx(1.7151368).margin(5e-8));
  CHECK(monopole_by_grid(cow->vertices(), 128) == Approx(exact).epsilon(1e-3));
}
