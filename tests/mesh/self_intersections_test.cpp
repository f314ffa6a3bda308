#include "host/mesh/self_intersections.hpp"

#include "host/error.hpp"
#include "host/geometry/orientation.hpp"
#include "host/mesh/builtin.hpp"
#include "tests/support/cgal_intersections.hpp"
#include "tests/support/meshes.hpp"

#include <boost/multiprecision/cpp_int.hpp>
#include <catch2/catch.hpp>

#include <array>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

SelfIntersections intersections(const RawMesh& mesh, unsigned threads = 0) {
  return self_intersections(mesh.vertices, mesh.faces, Bvh(mesh.vertices, mesh.faces), silent_monitor(), threads);
}

// Another way to the same answer, in rational numbers: what two triangles have in common is a polygon, made by clipping one
// of them by the other's plane and by the planes through the other's edges that stand on it.
using Rational = boost::multiprecision::cpp_rational;
using Exact = std::array<Rational, 3>;

Exact exact(const Vec3& p) {
  return {Rational(p.x()), Rational(p.y()), Rational(p.z())};
}
Exact minus(const Exact& a, const Exact& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Exact cross(const Exact& a, const Exact& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Rational dot(const Exact& a, const Exact& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The part of a polygon (or segment or point) where normal . (p - at) >= 0.
std::vector<Exact> clipped(const std::vector<Exact>& polygon, const Exact& normal, const Exact& at) {
  std::vector<Exact> part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Exact &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Rational u = dot(normal, minus(p, at)), v = dot(normal, minus(q, at));
    if (u >= 0) part.push_back(p);
    if ((u > 0 && v < 0) || (u < 0 && v > 0)) {
      const Rational t = u / (u - v);
      const Exact d = minus(q, p);
      part.push_back({p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]});
    }
  }
  return part;
}

/// 2 if the points span an area, 1 a segment, 0 a point, -1 if there is none.
int dimension(const std::vector<Exact>& points) {
  if (points.empty()) return -1;
  std::size_t other = 0;
  while (other < points.size() && points[other] == points[0]) ++other;
  if (other == points.size()) return 0;
  const Exact along = minus(points[other], points[0]);
  for (const Exact& p : points)
    if (cross(along, minus(p, points[0])) != Exact{0, 0, 0}) return 2;
  return 1;
}

struct Truth {
  Meeting meeting;
  bool segment; // of different planes
};

Truth rational_meeting(const std::vector<Vec3>& vertices, const Face& f, const Face& g) {
  std::array<Exact, 3> a, b;
  for (std::size_t k = 0; k < 3; ++k) a[k] = exact(vertices[f[k]]), b[k] = exact(vertices[g[k]]);
  const Exact normal = cross(minus(a[1], a[0]), minus(a[2], a[0])), other = cross(minus(b[1], b[0]), minus(b[2], b[0]));
  std::vector<Exact> common(b.begin(), b.end());
  for (const int side : {1, -1}) common = clipped(common, {side * normal[0], side * normal[1], side * normal[2]}, a[0]);
  for (std::size_t k = 0; k < 3; ++k) common = clipped(common, cross(normal, minus(a[(k + 1) % 3], a[k])), a[k]);
  int shared = 0;
  for (const std::uint32_t i : f)
    for (const std::uint32_t j : g) shared += i == j;
  const int size = dimension(common);
  if (size == 2) return {Meeting::overlapping, false};
  if (size < 0 || size == shared - 1) return {Meeting::none, false};
  const auto straddles = [](const std::array<Exact, 3>& t, const Exact& n, const Exact& at) {
    bool above = false, below = false;
    for (const Exact& p : t) above |= dot(n, minus(p, at)) > 0, below |= dot(n, minus(p, at)) < 0;
    return above && below;
  };
  const bool planes_differ = cross(normal, other) != Exact{0, 0, 0};
  const bool through = size == 1 && straddles(a, other, b[0]) && straddles(b, normal, a[0]);
  return {through ? Meeting::crossing : Meeting::touching, size == 1 && planes_differ};
}

/// Random triangles over few points: on a small lattice many share vertices, planes and edges.
RawMesh soup(std::mt19937& random, int points, int faces, int lattice, bool flat) {
  RawMesh mesh;
  std::uniform_int_distribution<int> coordinate(-lattice, lattice);
  std::uniform_int_distribution<std::uint32_t> vertex(0, std::uint32_t(points) - 1);
  for (int i = 0; i < points; ++i)
    mesh.vertices.emplace_back(coordinate(random), coordinate(random), flat ? 0 : coordinate(random));
  for (int i = 0; i < faces; ++i) mesh.faces.push_back({vertex(random), vertex(random), vertex(random)});
  return mesh;
}

bool has_area(const RawMesh& mesh, const Face& f) {
  return axis_with_area(mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]) >= 0;
}

/// Every pair by rational arithmetic; counts what there was of each kind.
void compare_with_rational(const RawMesh& mesh, std::array<std::size_t, 4>& kinds) {
  const SelfIntersections found = intersections(mesh);
  std::size_t at = 0, different = 0;
  for (std::uint32_t i = 0; i < mesh.faces.size(); ++i)
    for (std::uint32_t j = i + 1; j < mesh.faces.size(); ++j) {
      if (!has_area(mesh, mesh.faces[i]) || !has_area(mesh, mesh.faces[j])) continue;
      const Truth truth = rational_meeting(mesh.vertices, mesh.faces[i], mesh.faces[j]);
      ++kinds[std::size_t(truth.meeting)];
      TrianglePair pair;
      if (at < found.pairs.size() && found.pairs[at].first == i && found.pairs[at].second == j)
        pair = found.pairs[at++].how;
      different += pair.meeting != truth.meeting || pair.segment != truth.segment;
      different += meet(mesh.vertices, mesh.faces[j], mesh.faces[i]).meeting != truth.meeting;
    }
  CHECK(different == 0);
  CHECK(at == found.pairs.size());
}

} // namespace

TEST_CASE("pairs of faces of random soups meet as they do in rational arithmetic", "[self-intersections]") {
  std::mt19937 random(21);
  std::array<std::size_t, 4> kinds{};
  for (const int lattice : {1, 2, 4})
    for (int i = 0; i < 40; ++i) compare_with_rational(soup(random, 12, 14, lattice, i % 4 == 0), kinds);
  for (const std::size_t count : kinds) CHECK(count > 500);
}

TEST_CASE("faces a rounding apart meet as they do in rational arithmetic", "[self-intersections]") {
  std::mt19937 random(22);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::array<std::size_t, 4> kinds{};
  for (int i = 0; i < 150; ++i) {
    RawMesh mesh = rotated(soup(random, 10, 10, 1, i % 4 == 0),
                           Eigen::AngleAxisd(uniform(random), Vec3(1, 2, 3).normalized()).toRotationMatrix());
    if (i % 2)
      for (Vec3& p : mesh.vertices) p = p.cast<float>().cast<double>();
    compare_with_rational(mesh, kinds);
  }
  for (std::size_t kind = 0; kind < 3; ++kind) CHECK(kinds[kind] > 100);
}

TEST_CASE("the common segment of crossing faces lies in both", "[self-intersections]") {
  const RawMesh mesh = together(icosphere(2), translated(icosphere(2), {0.3, 0.2, 0.1}));
  const SelfIntersections found = intersections(mesh);
  REQUIRE(found.crossing > 50);
  double worst = 0;
  for (const FacePair& pair : found.pairs)
    for (const std::uint32_t face : {pair.first, pair.second}) {
      const Bvh one(mesh.vertices, std::span(&mesh.faces[face], 1));
      for (const Vec3& p : {pair.how.from, pair.how.to}) worst = std::max(worst, std::sqrt(one.closest(p).distance2));
    }
  INFO(worst);
  CHECK(worst < 4e-15);
}

TEST_CASE("bodies that do not intersect themselves have no pairs", "[self-intersections]") {
  for (const char* name : {"cow@1", "cow@2", "sphere@4", "box:1,2,3", "box@3", "ellipsoid:3,2,1@3", "tetrahedron"}) {
    INFO(name);
    CHECK(intersections(builtin_mesh(name)).pairs.empty());
  }
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) CHECK(intersections(convex_polyhedron(random, 40, 6)).pairs.empty());
  CHECK(intersections(torus(60, 30)).pairs.empty());
  CHECK(intersections(two_shells()).pairs.empty());
  CHECK(intersections(shell_with_cavity()).pairs.empty());
  CHECK(intersections(RawMesh{}).pairs.empty());
}

TEST_CASE("pairs do not depend on the number of threads or the order of faces", "[self-intersections]") {
  const RawMesh mesh = together(torus(50, 20), translated(torus(40, 30), {1, 0.5, 0.25}));
  const SelfIntersections one = intersections(mesh, 1), three = intersections(mesh, 3),
                          other = intersections(shuffled(mesh, 5));
  CHECK(one.crossing > 100);
  CHECK(one.touching == 0);
  REQUIRE(one.pairs.size() == three.pairs.size());
  for (std::size_t i = 0; i < one.pairs.size(); ++i) {
    CHECK(one.pairs[i].first == three.pairs[i].first);
    CHECK(one.pairs[i].how.from == three.pairs[i].how.from);
  }
  CHECK(other.crossing == one.crossing);
  CHECK(other.faces == one.faces);
}

TEST_CASE("a search for pairs stops when told to", "[self-intersections]") {
  struct Impatient : Monitor {
    bool stopped() const override { return true; }
  } impatient;
  const RawMesh mesh = icosphere(2);
  CHECK_THROWS_AS(self_intersections(mesh.vertices, mesh.faces, Bvh(mesh.vertices, mesh.faces), impatient), Error);
}

TEST_CASE("as many pairs meet as CGAL finds", "[self-intersections][cgal]") {
  const auto compare = [](const char* name, const RawMesh& mesh) {
    INFO(name);
    CHECK(intersections(mesh).pairs.size() == cgal_self_intersections(mesh.vertices, mesh.faces));
  };
  compare("two balls", together(icosphere(3), translated(icosphere(3), {0.5, 0.25, 0.125})));
  compare("boxes with common walls", together(box({2, 2, 2}), box({1, 1, 3})));
  for (const char* name : {"bull", "camel"})
    if (const auto body = demo_body(name)) compare(name, body->mesh());
  if (const auto cow = benchmark_cow()) compare("benchmark", cow->mesh());
}

TEST_CASE("the benchmark has 83 pairs of faces that cross and none that overlap", "[self-intersections]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const SelfIntersections found = intersections(cow->mesh());
  CHECK(found.crossing == 83);
  CHECK(found.overlapping == 0);
  CHECK(found.touching == 35); // at its two vertices of one place: 6 faces and 6, one pair of which crosses
  CHECK(found.complete);
}
