#include "host/geometry/bvh.hpp"

#include "host/error.hpp"
#include "host/mesh/builtin.hpp"
#include "host/spectrum/surface_distance.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace cowgpu;

namespace {

/// Distance of p from the box [0, 1]^3's surface.
double box_distance(const Vec3& p) {
  const Vec3 outside = (-p).cwiseMax(p - Vec3::Ones()).cwiseMax(0.0);
  if (outside.norm() > 0) return outside.norm();
  return std::min(p.minCoeff(), (Vec3::Ones() - p).minCoeff());
}

Vec3 uniform(std::mt19937& random, double low, double high) {
  const auto one = [&] { return low + (high - low) * double(random()) / 4294967296.0; };
  const double x = one(), y = one();
  return {x, y, one()};
}

} // namespace

TEST_CASE("closest points of a box are where they must be", "[bvh]") {
  for (const int level : {0, 1, 4}) {
    const RawMesh box = builtin_mesh("box@" + std::to_string(level)); // centred
    const Bvh tree(box.vertices, box.faces);
    std::mt19937 random(3);
    double worst = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 p = uniform(random, -1.5, 1.5);
      const ClosestPoint found = tree.closest(p);
      worst = std::max(worst, std::abs(std::sqrt(found.distance2) - box_distance(p + Vec3::Constant(0.5))));
      worst = std::max(worst, std::abs((found.point - p).norm() - std::sqrt(found.distance2)));
    }
    INFO(worst);
    CHECK(worst < 2e-15);
  }
}

TEST_CASE("the tree finds what a search of every triangle finds, with the same face", "[bvh]") {
  std::mt19937 random(11);
  RawMesh soup = test::together(test::torus(17, 9), test::convex_polyhedron(random, 60, 9));
  for (int i = 0; i < 50; ++i) { // long thin triangles, repeated ones and such without area
    const auto base = std::uint32_t(soup.vertices.size());
    for (int k = 0; k < 3; ++k) soup.vertices.push_back(uniform(random, -9, 9).cwiseProduct(Vec3(1, 0.01, 1)));
    soup.faces.push_back({base, base + 1, base + 2});
    soup.faces.push_back({base, base + 1, base + 2});
    soup.faces.push_back({base, base, base + 1});
  }
  const Bvh tree(soup.vertices, soup.faces);
  std::vector<Bvh> single;
  for (std::size_t f = 0; f < soup.faces.size(); ++f) single.emplace_back(soup.vertices, std::span(&soup.faces[f], 1));
  std::size_t hits = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 p = uniform(random, -10, 10);
    ClosestPoint best;
    for (std::size_t f = 0; f < single.size(); ++f)
      if (const auto c = single[f].closest(p); c.distance2 < best.distance2)
        best = {std::uint32_t(f), c.point, c.distance2};
    const ClosestPoint found = tree.closest(p);
    CHECK(found.distance2 == best.distance2);
    CHECK(found.face == best.face);
    CHECK(tree.closest(p, best.distance2).distance2 == HUGE_VAL);
    CHECK(tree.closest(p, best.distance2 * 1.001).face == best.face);

    Vec3 d = uniform(random, -1, 1);
    if (i % 4 == 0) d[i / 4 % 3] = 0;
    if (i % 16 == 0) d = Vec3::Unit(i / 16 % 3);
    const Ray ray{p, d, i % 2 ? HUGE_VAL : 8.0};
    RayHit first, one;
    bool any = false;
    first.t = HUGE_VAL;
    for (std::size_t f = 0; f < single.size(); ++f)
      if (single[f].first_hit(ray, one) && one.t < first.t) first = one, first.face = std::uint32_t(f), any = true;
    RayHit hit;
    REQUIRE(tree.first_hit(ray, hit) == any);
    if (!any) continue;
    ++hits;
    CHECK(hit.face == first.face);
    CHECK(hit.t == first.t);
  }
  CHECK(hits > 50);
}

TEST_CASE("no ray slips through an edge or a corner", "[bvh]") {
  const RawMesh sphere = test::icosphere(3), box = builtin_mesh("box@3");
  const Bvh round(sphere.vertices, sphere.faces), flat(box.vertices, box.faces);
  std::mt19937 random(5);
  std::size_t missed = 0;
  RayHit hit;
  for (const Face& f : sphere.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = sphere.vertices[f[k]], b = sphere.vertices[f[(k + 1) % 3]];
      const double s = double(random()) / 4294967296.0;
      const Vec3 aims[] = {a, a / 2 + b / 2, a + s * (b - a)};
      for (const Vec3& aim : aims) { // from the middle outwards, and from outside
        missed += !round.first_hit({Vec3::Zero(), aim}, hit);
        missed += !round.first_hit({3 * aim, -aim}, hit);
      }
    }
  for (int i = 0; i <= 16; ++i) // along the axes, through every grid line of the side
    for (int j = 0; j <= 16; ++j)
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 from(i / 16.0 - 0.5, j / 16.0 - 0.5, 0);
        from = Vec3(from[axis], from[(axis + 1) % 3], from[(axis + 2) % 3]);
        const int along = (2 - axis + 3) % 3;
        from[along] = 4;
        const bool found = flat.first_hit({from, -Vec3::Unit(along)}, hit);
        missed += !found || std::abs(hit.t - 3.5) > 1e-15;
      }
  CHECK(missed == 0);
}

TEST_CASE("a tree of nothing, of one point and of many equal triangles works", "[bvh]") {
  const Bvh none({}, {});
  RayHit hit;
  CHECK_FALSE(none.first_hit({Vec3::Zero(), Vec3(1, 0, 0)}, hit));
  CHECK(none.closest(Vec3::Zero()).distance2 == HUGE_VAL);
  const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Face> point = {{1, 1, 1}};
  const Bvh dot(corners, point);
  CHECK(dot.closest({3, 0, 0}).distance2 == 4);
  CHECK_FALSE(dot.first_hit({{3, 0, 0}, {-1, 0, 0}}, hit));
  const std::vector<Face> equal(1000, Face{0, 1, 2});
  const Bvh pile(corners, equal);
  REQUIRE(pile.first_hit({{0.2, 0.2, 5}, {0, 0, -2}}, hit));
  CHECK(hit.face == 0);
  CHECK(hit.t == 2.5);
  CHECK(pile.closest({0.2, 0.2, 5}).face == 0);
}

TEST_CASE("samples share the area evenly", "[surface-distance]") {
  const RawMesh box = test::box({1, 2, 3});
  const auto samples = area_samples(box.vertices, box.faces, 2200);
  REQUIRE(samples.size() == 2200);
  int on[3] = {0, 0, 0};
  for (const Vec3& p : samples)
    for (int c = 0; c < 3; ++c)
      if (p[c] == 0 || p[c] == Vec3(1, 2, 3)[c]) ++on[c];
  CHECK(std::abs(on[0] - 1200) <= 2); // two sides of 2 x 3 of an area of 22
  CHECK(std::abs(on[1] - 600) <= 2);
  CHECK(std::abs(on[2] - 400) <= 2);
  CHECK(area_samples(box.vertices, {}, 10).empty());
}

TEST_CASE("nested boxes and balls are as far apart as they are", "[surface-distance]") {
  Monitor silent;
  const RawMesh inner = test::box({1, 1, 1}), outer = test::box({1.2, 1.2, 1.2}, {-0.1, -0.1, -0.1});
  const SurfaceDistance boxes =
      surface_distance(inner.vertices, inner.faces, outer.vertices, outer.faces, 5000, 2, silent);
  CHECK(boxes.forth.largest == Approx(0.1).epsilon(1e-13));
  CHECK(boxes.forth.rms == Approx(0.1).epsilon(1e-13));
  CHECK(boxes.back.largest == Approx(0.1 * std::sqrt(3.0)).epsilon(1e-14));
  // On a side of 1.2: over the inner square 0.01, over the four strips of 0.1 the mean of 0.01 + s^2, and the corners.
  const double strip = 0.01 + 0.01 / 3, corner = 0.01 + 0.02 / 3;
  CHECK(boxes.back.rms == Approx(std::sqrt((0.01 + 4 * 0.1 * strip + 4 * 0.01 * corner) / 1.44)).epsilon(2e-3));
  CHECK(boxes.largest() == boxes.back.largest);

  const RawMesh small = test::icosphere(5), large = test::icosphere(5, 1.25);
  const SurfaceDistance balls =
      surface_distance(small.vertices, small.faces, large.vertices, large.faces, 5000, 0, silent);
  CHECK(balls.rms() == Approx(0.25).epsilon(1e-3)); // the triangles' sagitta
  const SurfaceDistance again =
      surface_distance(small.vertices, small.faces, large.vertices, large.faces, 5000, 1, silent);
  CHECK(balls.rms() == again.rms());
  CHECK(balls.largest() == again.largest());
  CHECK_THROWS_AS(surface_distance(small.vertices, {}, large.vertices, large.faces, 10, 1, silent), Error);
}
