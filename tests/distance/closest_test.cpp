#include "host/error.hpp"
#include "host/mesh/builtin.hpp"
#include "host/plan/closest_query.hpp"
#include "tests/support/compare_closest.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

constexpr double figure = 1e-15;

std::vector<Vec3> joined(std::vector<Vec3> a, const std::vector<Vec3>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Everywhere about a mesh, on it, and next to it.
std::vector<Vec3> queries_all_over(const RawMesh& mesh, std::size_t count, std::uint32_t seed) {
  return joined(joined(queries_in_box(mesh, count, 1.5, seed), queries_near_surface(mesh, count, 0.02, seed)),
                queries_at_edges(mesh, count, seed));
}

double box_distance(const Vec3& p) { // from the box [0, 1]^3, negative inside
  const Vec3 outside = (-p).cwiseMax(p - Vec3::Ones());
  return outside.maxCoeff() > 0 ? outside.cwiseMax(0.0).norm() : outside.maxCoeff();
}

std::string refusal(const RawMesh& mesh, const std::vector<Vec3>& queries, bool with_sign, Fault fault) {
  std::string words;
  Paths paths;
  paths.each([&](Backend& backend) {
    try {
      closest(backend, mesh, queries, with_sign);
      FAIL("not refused");
    } catch (const Error& error) {
      CHECK(error.fault() == fault);
      words = error.what();
    }
  });
  return words;
}

} // namespace

TEST_CASE("closest points and signs are the reference's on every path, for any number of queries", "[closest]") {
  Paths paths;
  std::mt19937 random(3);
  for (const RawMesh& mesh :
       {box({1, 2, 3}), tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), convex_polyhedron(random, 40, 9),
        icosphere(2), torus(17, 9), two_shells(), shell_with_cavity()})
    for (const std::size_t count : {0, 1, 7, 13})
      compare_closest(paths, mesh, queries_all_over(mesh, count, std::uint32_t(count)), figure);
  compare_closest(paths, icosphere(2), queries_in_box(icosphere(2), 1025, 1.1, 1), figure);
  compare_closest(paths, torus(17, 9), queries_near_surface(torus(17, 9), 1025, 0.02, 2), figure);
  compare_closest(paths, shell_with_cavity(), queries_at_edges(shell_with_cavity(), 1025, 3), figure);
}

TEST_CASE("closest points of bodies with more faces than a leaf or a node holds", "[closest]") {
  Paths paths;
  const RawMesh ball = icosphere(1);
  for (const std::size_t faces : {1, 2, 15, 16, 17, 31, 33}) {
    const RawMesh some = some_faces(ball, faces, 7);
    compare_closest(paths, some, queries_all_over(some, 100, std::uint32_t(faces)), figure, false);
  }
  const RawMesh many = torus(90, 40); // splits by bins
  compare_closest(paths, many, queries_all_over(many, 20, 1), figure);
}

TEST_CASE("closest points do not depend on a mesh's place and size", "[closest]") {
  Paths paths;
  for (const double factor : {1e-90, 1e-20, 1e20, 1e90}) {
    const RawMesh mesh = scaled(torus(9, 7), {factor, factor, factor});
    compare_closest(paths, mesh, queries_all_over(mesh, 50, 1), figure);
  }
  // The diagonal is 1e-6 of the coordinates, whose rounding unit the reference has as well.
  const RawMesh away = translated(torus(9, 7), {1e7, -2e7, 3e6});
  compare_closest(paths, away, queries_all_over(away, 100, 1), figure);
}

TEST_CASE("closest points of needles, of faces without area and of a soup of both", "[closest]") {
  Paths paths;
  for (const double width : {1e-3, 1e-7, 1e-12}) {
    const RawMesh needle = scaled(torus(9, 7), {width, 1, 1}), rod = scaled(torus(9, 7), {width, width, 1});
    compare_closest(paths, needle, queries_all_over(needle, 100, 1), figure);
    compare_closest(paths, rod, queries_all_over(rod, 100, 1), figure);
    compare_closest(paths, needle, queries_in_box(torus(9, 7), 100, 1.1, 1), figure);
  }
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double width : {1.0, 1e-4, 1e-9, 1e-15, 0.0}) {
    RawMesh soup;
    for (std::uint32_t i = 0; i < 200; ++i) {
      const Vec3 a(uniform(random), uniform(random), uniform(random)), along(uniform(random), uniform(random), 1);
      for (int k = 0; k < 3; ++k) {
        const Vec3 aside(uniform(random), uniform(random), uniform(random));
        soup.vertices.emplace_back(a + uniform(random) * along + width * aside);
      }
      soup.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
      soup.faces.push_back({3 * i, 3 * i + 1, 3 * i}); // two corners the same
      soup.faces.push_back({3 * i + 1, 3 * i + 1, 3 * i + 1});
    }
    compare_closest(paths, soup, queries_all_over(soup, 100, 7), figure, false);
  }
}

TEST_CASE("closest points of a mesh of one point, or of one segment", "[closest]") {
  Paths paths;
  RawMesh mesh;
  mesh.vertices = {{1, 2, 3}, {1, 2, 4}, {1, 2, 3.5}};
  mesh.faces = {{0, 0, 0}};
  compare_closest(paths, mesh, {{0, 0, 0}, {1, 2, 3}, {5, 5, 5}}, figure, false);
  mesh.faces = {{0, 1, 2}};
  compare_closest(paths, mesh, {{0, 0, 0}, {1, 2, 3}, {5, 5, 5}, {1, 2, 3.25}, {1, 3, 3.75}}, figure, false);
}

TEST_CASE("closest points of far queries, alone and among near ones", "[closest]") {
  Paths paths;
  const RawMesh mesh = torus(17, 9);
  std::vector<Vec3> queries = queries_in_box(mesh, 200, 1.1, 1);
  for (const double factor : {1e2, 1e4, 1e5, 1e6, 1e9, 1e30, 1e90})
    queries = joined(queries, queries_in_box(mesh, 7, factor, 2));
  std::shuffle(queries.begin(), queries.end(), std::mt19937(1));
  compare_closest(paths, mesh, queries, figure);
}

TEST_CASE("winding numbers on a lattice, where rays run through edges and vertices, are exact", "[closest]") {
  Paths paths;
  std::mt19937 random(11);
  const RawMesh unit = box({2, 2, 2});
  // Overlapping (2), turned inside out (-1), and a cavity touching the outside.
  const RawMesh tangled =
      together(together(unit, translated(unit, {1, 1, 1})),
               together(flipped(translated(unit, {-2, 1, -1})), flipped(box({1, 1, 1}, {0, 0, 1}))));
  std::vector<Vec3> lattice;
  for (int i = -6; i <= 7; ++i)
    for (int j = -3; j <= 7; ++j)
      for (int k = -4; k <= 7; ++k) lattice.emplace_back(0.5 * i, 0.5 * j, 0.5 * k);
  compare_closest(paths, tangled, lattice, figure);
  for (int repeat = 0; repeat < 4; ++repeat) {
    const RawMesh body = convex_polyhedron(random, 30, 3);
    std::vector<Vec3> integers;
    for (int i = -3; i <= 3; ++i)
      for (int j = -3; j <= 3; ++j)
        for (int k = -3; k <= 3; ++k) integers.emplace_back(i, j, k);
    compare_closest(paths, together(body, translated(body, {1, 0, 2})), integers, figure);
  }
}

TEST_CASE("the signed distance of a box is its closed form", "[closest]") {
  Paths paths;
  for (const char* name : {"box@0", "box@2", "box@5"}) {
    RawMesh mesh = builtin_mesh(name); // centred
    for (Vec3& v : mesh.vertices) v += Vec3::Constant(0.5);
    std::vector<Vec3> queries = queries_in_box(mesh, 2000, 2, 1);
    paths.each([&](Backend& backend) {
      const ClosestPoints found = closest(backend, mesh, queries);
      double worst = 0;
      for (std::size_t i = 0; i < queries.size(); ++i) {
        worst = std::max(worst, std::abs(found.distance[i] - box_distance(queries[i])));
        CHECK(found.winding[i] == (box_distance(queries[i]) < 0 ? 1 : 0));
      }
      check_at_most(worst, 1e-15, name);
    });
  }
}

TEST_CASE("the signed distance of a tessellated ball tends to the ball's with the square of the edges", "[closest]") {
  Paths paths;
  paths.each([&](Backend& backend) {
    double before = 0;
    for (const int level : {2, 3, 4, 5}) {
      const RawMesh mesh = icosphere(level);
      const std::vector<Vec3> queries = queries_in_box(mesh, 3000, 1.5, 1);
      const ClosestPoints found = closest(backend, mesh, queries);
      // Outside the mesh is the farther by at most the sagitta, inside the nearer.
      double longest = 0, worst = 0;
      for (const Face& f : mesh.faces) longest = std::max(longest, (mesh.vertices[f[0]] - mesh.vertices[f[1]]).norm());
      const double sagitta = 1 - std::sqrt(1 - longest * longest / 3);
      for (std::size_t i = 0; i < queries.size(); ++i) {
        const double error = found.distance[i] - (queries[i].norm() - 1);
        CHECK((error > -1e-15 && error <= sagitta));
        worst = std::max(worst, error);
      }
      if (before > 0) CHECK(std::abs(std::log2(before / worst) - 2) < 0.2);
      before = worst;
    }
  });
}

TEST_CASE("closest points depend neither on threads nor on the other queries, and one at a time gives the same",
          "[closest]") {
  const RawMesh mesh = together(torus(40, 20), translated(torus(9, 7), {1, 0.5, 0.25}));
  const std::vector<Vec3> queries = queries_all_over(mesh, 1500, 1);
  const ClosestPoints all = closest(*make_cpu_backend(1), mesh, queries);
  const plan::ClosestTree tree(mesh.vertices, mesh.faces);
  std::vector<Vec3> backwards(queries.rbegin(), queries.rend());
  backwards.resize(1234);
  for (const unsigned threads : {2U, 3U}) {
    const auto backend = make_cpu_backend(threads);
    const ClosestPoints found = closest(*backend, mesh, queries), part = closest(*backend, mesh, backwards);
    CHECK((found.distance == all.distance && found.point == all.point && found.face == all.face));
    CHECK((found.feature == all.feature && found.barycentric == all.barycentric && found.winding == all.winding));
    for (std::size_t i = 0; i < part.size(); ++i) {
      const std::size_t j = queries.size() - 1 - i;
      CHECK((part.distance[i] == all.distance[j] && part.face[i] == all.face[j] && part.winding[i] == all.winding[j]));
    }
  }
  std::uint32_t warm = no_face;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const double d = std::abs(all.distance[i]);
    const auto cold = plan::closest_point(tree, queries[i]),
               bounded = plan::closest_point(tree, queries[i], d * (1 + 1e-9) + 1e-300, warm);
    REQUIRE((cold && bounded));
    for (const SurfacePoint& found : {*cold, *bounded}) {
      CHECK((found.distance == d && found.face == all.face[i] && found.point == all.point[i]));
      CHECK((found.feature == all.feature[i] && found.barycentric == all.barycentric[i]));
    }
    if (d > 1e-9) CHECK_FALSE(plan::closest_point(tree, queries[i], d * (1 - 1e-9), warm));
    CHECK(plan::winding_number(tree, queries[i]) == all.winding[i]);
    warm = cold->face;
  }
}

TEST_CASE("the benchmark's overlap, its bubble and its two vertices at one point have the right signs", "[closest]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const RawMesh& mesh = cow->mesh();
  Paths paths;
  std::vector<Vec3> queries = joined(queries_in_box(mesh, 60, 1.1, 1), queries_near_surface(mesh, 60, 0.005, 2));
  queries = joined(queries, queries_at_edges(mesh, 60, 3));
  // About the two vertices at one point.
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal(0, 1e-4);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    for (std::size_t w = 0; w < v; ++w)
      if (mesh.vertices[v] == mesh.vertices[w]) {
        queries.push_back(mesh.vertices[v]);
        for (int i = 0; i < 10; ++i)
          queries.push_back(mesh.vertices[v] + Vec3(normal(random), normal(random), normal(random)));
      }
  // Of the points near the surface those with a winding number other than 0 and 1, of which there are few.
  const std::vector<Vec3> near = queries_near_surface(mesh, 400000, 1e-5, 5);
  const ClosestPoints found = closest(*make_cpu_backend(), mesh, near);
  int twice = 0, inside_out = 0;
  for (std::size_t i = 0; i < near.size(); ++i)
    if (found.winding[i] != 0 && found.winding[i] != 1) {
      if ((found.winding[i] > 0 ? twice : inside_out)++ < 10) queries.push_back(near[i]);
    }
  CHECK(twice >= 10);
  CHECK(inside_out >= 10);
  CHECK(queries.size() == 60 + 60 + 60 + 2 * 10 + 11);
  compare_closest(paths, mesh, queries, figure);
}

TEST_CASE("closest points are refused where there is no answer", "[closest]") {
  const RawMesh mesh = icosphere(1);
  const std::string bad = refusal(mesh, {{0, 0, 0}, {0, NAN, 0}}, true, Fault::bad_argument);
  CHECK_THAT(bad, Catch::Contains("point 1 of 2"));
  refusal(mesh, {{0, 0, INFINITY}}, false, Fault::bad_argument);
  refusal(mesh, {{0, 2e100, 0}}, false, Fault::bad_argument);
  CHECK_THAT(refusal(some_faces(mesh, 7), {{0, 0, 0}}, true, Fault::mesh_open), Catch::Contains("without sign"));
  RawMesh broken = mesh;
  broken.faces.clear();
  refusal(broken, {{0, 0, 0}}, false, Fault::mesh_empty);
  broken = mesh;
  broken.faces[3][1] = 9999;
  refusal(broken, {{0, 0, 0}}, false, Fault::mesh_index_range);
  broken = mesh;
  broken.vertices[3].y() = NAN;
  refusal(broken, {{0, 0, 0}}, false, Fault::mesh_not_finite);
  refusal(scaled(mesh, Vec3::Constant(2e100)), {{0, 0, 0}}, false, Fault::mesh_range);
  refusal(scaled(mesh, Vec3::Constant(1e-110)), {{0, 0, 0}}, false, Fault::mesh_range);
}

TEST_CASE("an interrupt ends a search for closest points", "[closest]") {
  struct Stopped : Monitor {
    bool stopped() const override { return true; }
  } stopped;
  const RawMesh mesh = icosphere(1);
  const std::vector<Vec3> queries(100, Vec3(1, 2, 3));
  Paths paths;
  paths.each([&](Backend& backend) {
    try {
      backend.distance_field(mesh.vertices, mesh.faces)->closest(queries, {}, stopped);
      FAIL("not interrupted");
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::interrupted);
    }
  });
}
