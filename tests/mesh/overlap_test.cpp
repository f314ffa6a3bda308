#include "host/mesh/overlap.hpp"

#include "host/backend.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/inscribed.hpp"
#include "host/mesh/winding.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <numbers>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

Overlap overlap_of(const RawMesh& mesh, unsigned threads = 0) {
  const Bvh tree(mesh.vertices, mesh.faces);
  const SelfIntersections pairs = self_intersections(mesh.vertices, mesh.faces, tree, silent_monitor(), threads);
  return overlap(mesh.vertices, mesh.faces, tree, pairs, silent_monitor(), threads);
}

/// Relative to `size`: the body's volume, or what is expected.
void check_volume(const RegionVolume& found, double expected, double size) {
  INFO(found.volume << " +- " << found.uncertainty << ", expected " << expected);
  CHECK(std::abs(found.volume - expected) <= 1e-13 * size);
  CHECK(std::abs(found.volume - expected) <= found.uncertainty + 1e-15 * size);
  CHECK(found.uncertainty <= 1e-12 * size);
}

Eigen::Matrix3d some_rotation() {
  return Eigen::AngleAxisd(0.7, Vec3(1, -2, 3).normalized()).toRotationMatrix();
}

} // namespace

TEST_CASE("boxes that overlap share the product of three lengths", "[overlap]") {
  const RawMesh two = together(box({2, 3, 5}), box({2, 3, 5}, {1, 1, 1}));
  for (const RawMesh& mesh :
       {two, rotated(two, some_rotation()), shuffled(two, 4), translated(two, {1e3, -1e3, 5e2})}) {
    const Overlap found = overlap_of(mesh);
    INFO(found.overlapped.volume << " +- " << found.overlapped.uncertainty);
    CHECK(found.overlapped.volume == Approx(8).epsilon(1e-12));
    CHECK(std::abs(found.overlapped.volume - 8) <= found.overlapped.uncertainty + 2e-12);
    CHECK(found.inverted.volume == 0);
  }
}

TEST_CASE("three boxes that overlap count each region once", "[overlap]") {
  const RawMesh mesh =
      together(together(box({4, 1, 1}), box({4, 1, 1}, {1, 0.25, 0.25})), box({4, 1, 1}, {2, 0.5, -0.25}));
  // Pairs less twice the triple, each a product of intervals.
  const double ab = 3 * 0.75 * 0.75, bc = 3 * 0.75 * 0.5, ac = 2 * 0.5 * 0.75, abc = 2 * 0.5 * 0.5;
  check_volume(overlap_of(mesh).overlapped, ab + bc + ac - 2 * abc, 12);
}

TEST_CASE("balls that overlap share a lens", "[overlap]") {
  const Vec3 shift(0.8, 0.72, 0.54);
  const double d = shift.norm(), lens = std::numbers::pi * (4 + d) * (2 - d) * (2 - d) / 12;
  double before = 1;
  for (const int level : {2, 3, 4}) {
    const RawMesh ball = icosphere(level);
    const RegionVolume found = overlap_of(together(ball, translated(rotated(ball, some_rotation()), shift))).overlapped;
    const double error = std::abs(found.volume - lens) / lens;
    INFO("level " << level << ": " << error);
    CHECK(error < before / 3); // as the triangles' sagitta
    CHECK(found.uncertainty < 1e-12);
    before = error;
  }
  CHECK(before < 0.02);
}

TEST_CASE("a shell inside a shell is overlapped whole without any intersection", "[overlap]") {
  const RawMesh inner = translated(icosphere(2, 0.5), {0.1, 0.2, 0.05}), outer = box({3, 3, 3}, {-1.5, -1.5, -1.5});
  const double inside = volume(inner.vertices, inner.faces);
  check_volume(overlap_of(together(outer, inner)).overlapped, inside, 27);
  check_volume(overlap_of(together(outer, flipped(inner))).overlapped, 0, 27);
  const RawMesh innermost = translated(icosphere(1, 0.1), {0.1, 0.2, 0.05}); // winding number 3
  check_volume(overlap_of(together(together(outer, inner), innermost)).overlapped, inside, 27);
}

TEST_CASE("what is inside out is told apart", "[overlap]") {
  const RawMesh mesh = together(box({3, 3, 3}), flipped(box({1, 1, 2}, {5, 0, 0})));
  check_volume(overlap_of(mesh).inverted, 2, 27);
  check_volume(overlap_of(mesh).overlapped, 0, 27);
  // A hole that sticks out of its body: outside it is inside out.
  check_volume(overlap_of(together(box({2, 2, 2}), flipped(box({1, 1, 2}, {0.5, 0.5, 1})))).inverted, 1, 8);
}

TEST_CASE("walls that lie on each other are counted once", "[overlap]") {
  const RawMesh body = box({2, 2, 2});
  check_volume(overlap_of(together(body, box({1, 1, 1}))).overlapped, 1, 8);                // in a corner
  check_volume(overlap_of(together(body, box({1, 1, 1}, {2, 0.5, 0.5}))).overlapped, 0, 8); // outside a wall
  check_volume(overlap_of(together(body, flipped(box({1, 1, 1})))).overlapped, 0, 8);       // cut out of a corner
  check_volume(overlap_of(together(body, shuffled(body, 3))).overlapped, 8, 8);             // twice the same
  check_volume(overlap_of(together(body, box({3, 1, 1}, {-0.5, 0, 0}))).overlapped, 2, 8);  // through it along a wall
  check_volume(overlap_of(together(together(body, body), flipped(box({1, 2, 2})))).overlapped, 4, 8);
  const RawMesh ball = icosphere(3);
  check_volume(overlap_of(together(ball, shuffled(ball, 8))).overlapped, volume(ball.vertices, ball.faces), 4);
}

namespace {

void check_walls_a_rounding_apart(int turns) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const RawMesh body = box({2, 2, 2});
  const std::pair<RawMesh, double> bodies[] = {{together(body, box({1, 1, 1})), 1},
                                               {together(body, box({3, 1, 1}, {-0.5, 0, 0})), 2},
                                               {together(body, body), 8}};
  for (int i = 0; i < turns; ++i)
    for (const auto& [mesh, truth] : bodies) {
      const Vec3 axis = Vec3(uniform(random), uniform(random), uniform(random)).normalized();
      RawMesh turned = rotated(mesh, Eigen::AngleAxisd(3 * uniform(random), axis).toRotationMatrix());
      if (i % 2) // coordinates change by a rounding, shell by shell
        for (Vec3& p : turned.vertices) p += 1e-16 * Vec3::NullaryExpr([&](int) { return uniform(random); });
      const RegionVolume found = overlap_of(turned, 1).overlapped;
      INFO(found.volume << " +- " << found.uncertainty << ", " << truth);
      CHECK(std::abs(found.volume - truth) <= found.uncertainty);
      CHECK(found.uncertainty <= 0.05 * truth);
    }
}

} // namespace

TEST_CASE("walls a rounding apart give a volume within its uncertainty", "[overlap]") {
  check_walls_a_rounding_apart(2);
}

TEST_CASE("walls a rounding apart, turned in many ways, give a volume within its uncertainty", "[overlap][long]") {
  check_walls_a_rounding_apart(16);
}

TEST_CASE("the overlapped volume does not depend on threads, order or place", "[overlap]") {
  const RawMesh mesh = together(torus(40, 20), translated(torus(30, 24), {1, 0.5, 0.25}));
  const double one = overlap_of(mesh, 1).overlapped.volume;
  CHECK(one > 1);
  CHECK(overlap_of(mesh, 3).overlapped.volume == one);
  CHECK(overlap_of(shuffled(mesh, 9)).overlapped.volume == Approx(one).epsilon(1e-12));
  CHECK(overlap_of(rotated(mesh, some_rotation())).overlapped.volume == Approx(one).epsilon(1e-12));
  CHECK(overlap_of(scaled(mesh, {1e30, 1e30, 1e30})).overlapped.volume == Approx(1e90 * one).epsilon(1e-12));
}

TEST_CASE("the benchmark's overlapped volume is what points tell by their winding numbers", "[overlap]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const RawMesh& mesh = cow->mesh();
  const Bvh tree(mesh.vertices, mesh.faces);
  const SelfIntersections pairs = self_intersections(mesh.vertices, mesh.faces, tree, silent_monitor());
  const Overlap found = overlap(mesh.vertices, mesh.faces, tree, pairs, silent_monitor());
  CHECK(found.overlapped.volume == Approx(9.44125e-06).epsilon(1e-5));
  CHECK(found.overlapped.uncertainty < 1e-6 * found.overlapped.volume);
  CHECK(found.inverted.volume == Approx(7.99e-10).epsilon(1e-2));

  Vec3 low = Vec3::Constant(9), high = -low;
  for (const FacePair& pair : pairs.pairs)
    for (const std::uint32_t face : {pair.first, pair.second})
      for (const std::uint32_t v : mesh.faces[face])
        low = low.cwiseMin(mesh.vertices[v]), high = high.cwiseMax(mesh.vertices[v]);
  std::mt19937 random(1);
  std::vector<Vec3> points(400000);
  for (Vec3& p : points)
    for (int k = 0; k < 3; ++k) p[k] = low[k] + (high[k] - low[k]) * double(random()) / 4294967296.0;
  const auto field = make_cpu_backend()->distance_field(mesh.vertices, mesh.faces);
  const ClosestPoints closest = field->closest(points, {}, silent_monitor());
  const double box = (high - low).prod(), n = double(points.size());
  const double part =
      double(std::count_if(closest.winding.begin(), closest.winding.end(), [](int w) { return w >= 2; })) / n;
  const double sigma = box * std::sqrt(part * (1 - part) / n);
  INFO(box * part << " +- " << sigma);
  CHECK(sigma < 0.03 * found.overlapped.volume);
  CHECK(std::abs(box * part - found.overlapped.volume) < 4 * sigma);
}

TEST_CASE("winding numbers by the tree of boxes are those of the distance field", "[overlap][winding]") {
  const RawMesh mesh =
      together(together(torus(40, 20), translated(torus(30, 24), {1, 0.5, 0.25})), flipped(icosphere(2, 2)));
  const Bvh tree(mesh.vertices, mesh.faces);
  std::mt19937 random(6);
  std::vector<Vec3> points(20000);
  for (Vec3& p : points) p = 5 * Vec3::NullaryExpr([&](int) { return double(random()) / 2147483648.0 - 1; });
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    points[i] = Vec3(mesh.vertices[i].x(), mesh.vertices[i].y(), points[i].z());
  const auto field = make_cpu_backend()->distance_field(mesh.vertices, mesh.faces);
  const ClosestPoints truth = field->closest(points, {}, silent_monitor());
  std::size_t different = 0, several = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    different += winding_number(tree, mesh.vertices, mesh.faces, points[i]) != truth.winding[i];
    several += truth.winding[i] != 0 && truth.winding[i] != 1;
  }
  CHECK(different == 0);
  CHECK(several > 300);
}

TEST_CASE("inscribed balls are as large as they are", "[inscribed]") {
  const auto radius = [](const RawMesh& mesh, const Vec3& about) {
    const Bvh tree(mesh.vertices, mesh.faces);
    return inscribed_radius(mesh.vertices, mesh.faces, tree, tree, about);
  };
  CHECK(radius(box({2, 3, 5}), {0.75, 1, 2}) == 0.75);
  CHECK_FALSE(radius(box({2, 3, 5}), {3, 1, 2}));
  CHECK_FALSE(radius(torus(40, 20), Vec3::Zero()));
  CHECK_FALSE(radius(flipped(box({2, 3, 5})), {0.75, 1, 2}));

  const auto largest = [](const RawMesh& mesh) {
    const Bvh tree(mesh.vertices, mesh.faces);
    const TriangleSheet sheet =
        body_boundary(mesh.vertices, mesh.faces, tree,
                      self_intersections(mesh.vertices, mesh.faces, tree, silent_monitor()), silent_monitor());
    const LargestBall ball =
        largest_ball(mesh.vertices, mesh.faces, tree, Bvh(sheet.vertices, sheet.faces), silent_monitor());
    CHECK(ball.bound >= ball.radius);
    return ball;
  };
  for (const auto& [mesh, truth] :
       {std::pair(box({2, 3, 5}, {7, 8, 9}), 1.0),
        {together(box({2, 3, 5}), box({4, 4, 4}, {9, 0, 0})), 2.0},
        {rotated(box({4, 4, 4}), some_rotation()), 2.0},
        // Pieces of the surface inside the body do not bound it.
        {together(box({2, 2, 2}), box({2, 2, 2}, {0.5, 0, 0})), 1.0},
        {together(box({2, 2, 2}), box({1, 1, 1}, {0.5, 0.5, 0.5})), 1.0},
        {together(box({4, 4, 4}), rotated(box({1, 1, 9}, {1, 1, -3}), some_rotation())), 2.0},
        {together(box({2, 2, 2}), flipped(box({2, 2, 2}, {2.5, 0, 0}))), 1.0}}) {
    const LargestBall ball = largest(mesh);
    INFO(ball.radius << " to " << ball.bound);
    CHECK(ball.radius <= truth * (1 + 1e-14));
    CHECK(ball.bound >= truth * (1 - 1e-14));
    CHECK(ball.bound <= 1.02 * ball.radius);
  }
  const LargestBall tetrahedral = largest(tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  CHECK(tetrahedral.radius == Approx(1 / (3 + std::sqrt(3.0))).epsilon(1.1e-3));
  CHECK(tetrahedral.bound <= 1.001 * tetrahedral.radius);
  CHECK(largest(flipped(box({1, 1, 1}))).radius == 0);
}
