#include "host/backend.hpp"
#include "host/cpu/polyhedron_fast.hpp"
#include "host/error.hpp"
#include "host/mesh/builtin.hpp"
#include "host/mesh/subdivide.hpp"
#include "host/plan/polyhedron_settings.hpp"
#include "host/plan/polyhedron_tree.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/polyhedron_errors.hpp"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

PolyhedronValues direct(const RawMesh& mesh, const std::vector<Vec3>& points,
                        Derivatives derivatives = Derivatives::first) {
  return make_cpu_backend()->polyhedron(fast_problem(mesh, 0, derivatives))->at(points, silent_monitor());
}

PolyhedronValues fast(const PolyhedronProblem& asked, const std::vector<Vec3>& points, RunReport* report = nullptr,
                      unsigned threads = 0) {
  return cpu::fast_polyhedron(asked, threads)->at(points, silent_monitor(), report);
}

// At each face's centroid, for each tolerance with and without a guarantee.
void check_everywhere(const RawMesh& mesh) {
  const std::vector<Vec3> points = centroids(mesh);
  const PolyhedronValues truth = direct(mesh, points);
  for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
    INFO("tolerance " << tolerance << ", " << mesh.faces.size() << " faces");
    const FieldErrors plain = field_errors(mesh, fast(fast_problem(mesh, tolerance), points), truth);
    CHECK(plain.gradient < tolerance);
    CHECK(plain.value < tolerance);
    CHECK(plain.winding < 1000 * tolerance);
    const FieldErrors proven =
        field_errors(mesh, fast(fast_problem(mesh, tolerance, Derivatives::first, true), points), truth);
    CHECK(proven.gradient < tolerance);
    CHECK(proven.bound <= tolerance);
    CHECK(proven.bounded);
    CHECK(proven.bound < 300 * proven.gradient);
  }
}

} // namespace

TEST_CASE("the fast sum keeps its tolerance at every face of a cow, and bounds hold", "[polyhedron_fast]") {
  check_everywhere(builtin_mesh("cow@1"));
}

TEST_CASE("the fast sum keeps its tolerance at every face of large bodies", "[polyhedron_fast][long]") {
  check_everywhere(builtin_mesh("cow@2"));
  check_everywhere(builtin_mesh("asteroid:1@5"));
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  check_everywhere(split_midpoint(cow->mesh()));
}

TEST_CASE("the fast sum keeps its tolerance on bodies too thin for single precision", "[polyhedron_fast]") {
  for (const Vec3& axes : {Vec3(1, 1, 1e-6), Vec3(1, 1e-3, 1e-3)}) {
    RawMesh mesh = icosphere(4);
    for (Vec3& v : mesh.vertices) v = v.cwiseProduct(axes);
    const std::vector<Vec3> points = centroids(mesh);
    const PolyhedronValues truth = direct(mesh, points);
    INFO("axes " << axes.transpose());
    CHECK(field_errors(mesh, fast(fast_problem(mesh, 1e-6), points), truth).gradient < 1e-6);
    const FieldErrors proven =
        field_errors(mesh, fast(fast_problem(mesh, 1e-6, Derivatives::first, true), points), truth);
    CHECK(proven.gradient < 1e-6);
    CHECK(proven.bounded);
  }
}

TEST_CASE("second derivatives of the fast sum are those of the direct one", "[polyhedron_fast]") {
  const RawMesh mesh = builtin_mesh("cow@1");
  const std::vector<Vec3> points = centroids(mesh);
  const PolyhedronValues truth = direct(mesh, points, Derivatives::second);
  const PolyhedronValues found = fast(fast_problem(mesh, 1e-9, Derivatives::second), points);
  const FieldErrors worst = field_errors(mesh, found, truth);
  CHECK(worst.hessian < 1e-7);
  CHECK(worst.gradient < 1e-9);
}

TEST_CASE("the fast sum is right inside, far away, on vertices, and where points coincide", "[polyhedron_fast]") {
  const RawMesh mesh = builtin_mesh("cow@1");
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Vec3> scattered, along;
  for (int i = 0; i < 500; ++i) scattered.emplace_back(normal(random), normal(random), normal(random));
  for (int i = 0; i < 500; ++i) along.emplace_back(0.001 * i, 0.2, 0.1);
  std::vector<Vec3> distant;
  for (const double d : {3.0, 30.0, 1e3, 1e6, 1e12, 1e40}) distant.emplace_back(0.6 * d, 0.64 * d, 0.48 * d);
  for (const std::vector<Vec3>& points :
       {mesh.vertices, scattered, along, distant, std::vector<Vec3>(1000, Vec3(0.1, 0.1, 0.1)),
        std::vector<Vec3>(1, Vec3(0, 0, 0))}) {
    const PolyhedronValues truth = direct(mesh, points);
    const PolyhedronValues found = fast(fast_problem(mesh, 1e-9), points);
    const FieldErrors worst = field_errors(mesh, found, truth);
    CHECK(worst.gradient < 1e-9);
    CHECK(worst.value < 1e-9);
    for (std::size_t i = 0; i < points.size(); ++i) // far away too
      CHECK((found.field.gradient[i] - truth.field.gradient[i]).norm() <= 1e-8 * truth.field.gradient[i].norm());
  }
}

TEST_CASE("bodies of several shells, and whole numbers of turns, go through the fast sum", "[polyhedron_fast]") {
  const RawMesh cow = builtin_mesh("cow@1");
  const RawMesh overlapping = together(cow, translated(cow, Vec3(0.11, 0.07, 0.05)));
  const RawMesh hollow = together(builtin_mesh("sphere:1@4"), flipped(builtin_mesh("sphere:0.5@3")));
  for (const RawMesh& mesh : {overlapping, hollow}) {
    std::vector<Vec3> points = centroids(mesh);
    points.emplace_back(0.1, 0.1, 0.1);
    const PolyhedronValues truth = direct(mesh, points), found = fast(fast_problem(mesh, 1e-9), points);
    const FieldErrors worst = field_errors(mesh, found, truth);
    CHECK(worst.gradient < 1e-9);
    CHECK(worst.winding < 1e-6);
  }
}

TEST_CASE("bits of the fast sum do not depend on the number of threads", "[polyhedron_fast]") {
  const RawMesh mesh = builtin_mesh("cow@2");
  std::vector<Vec3> points = centroids(mesh);
  const PolyhedronProblem asked = fast_problem(mesh, 1e-9, Derivatives::second, true);
  const PolyhedronValues one = fast(asked, points, nullptr, 1), three = fast(asked, points, nullptr, 3);
  CHECK(one.field.value == three.field.value);
  CHECK(one.field.gradient == three.field.gradient);
  CHECK(one.field.hessian == three.field.hessian);
  CHECK(one.winding == three.winding);
  CHECK(one.bound == three.bound);
}

TEST_CASE("work and memory of the fast sum grow as faces and points do", "[polyhedron_fast]") {
  double first_work = 0, first_memory = 0;
  for (const char* body : {"cow@2", "cow@3"}) {
    const RawMesh mesh = builtin_mesh(body);
    const std::vector<Vec3> points = centroids(mesh);
    RunReport report;
    const PolyhedronProblem asked = fast_problem(mesh, 1e-6);
    const auto prepared = cpu::fast_polyhedron(asked, 0);
    prepared->at(points, silent_monitor(), &report);
    const double work = report.elements / double(points.size());
    const double memory = double(cpu::fast_polyhedron(asked, 1)->memory(10000000).host) / 1e7;
    if (first_work > 0) {
      CHECK(work < 1.6 * first_work);
      CHECK(memory < 1.6 * first_memory);
    }
    first_work = work;
    first_memory = memory;
  }
}

TEST_CASE("trees stay shallow whatever the places are", "[polyhedron_fast]") {
  for (const int kind : {0, 1, 2}) {
    const plan::PlaceTree tree(
        100000,
        [&](std::size_t i) {
          return kind == 0 ? Vec3(1, 2, 3) : kind == 1 ? Vec3(double(i), 0, 0) : Vec3(i % 2, 0, 0);
        },
        64, 2);
    CHECK(tree.depth() <= 12);
    CHECK(tree.cells.size() == plan::PlaceTree::cell_count(100000, 64));
    std::vector<bool> seen(100000);
    for (const std::uint32_t i : tree.order) seen[i] = true;
    CHECK(std::count(seen.begin(), seen.end(), true) == 100000);
  }
}

TEST_CASE("the fast sum is taken where it pays, refuses nonsense and stops", "[polyhedron_fast]") {
  const RawMesh mesh = builtin_mesh("cow@1");
  const std::vector<Vec3> points = centroids(mesh);
  CHECK_FALSE(plan::fast_sum_pays(fast_problem(mesh, 1e-9), 1));
  CHECK_FALSE(plan::fast_sum_pays(fast_problem(mesh, 0), 1000000000));
  PolyhedronProblem large = fast_problem(mesh, 1e-9);
  std::vector<Face> many;
  while (many.size() < 1000000) many.insert(many.end(), mesh.faces.begin(), mesh.faces.end());
  large.faces = many;
  CHECK(plan::fast_sum_pays(large, 1000000));
  CHECK_FALSE(plan::fast_sum_pays(large, 8));

  for (const double tolerance : {-1e-9, 1e-13, 0.1, std::nan("")}) {
    CHECK_THROWS_AS(fast(fast_problem(mesh, tolerance), points), Error);
    CHECK_THROWS_AS(make_cpu_backend()->polyhedron(fast_problem(mesh, tolerance))->at(points, silent_monitor()), Error);
  }
  CHECK_THROWS_AS(fast(fast_problem(mesh, 1e-9), {Vec3(0, 0, std::nan(""))}), Error);
  struct : Monitor {
    bool stopped() const override { return true; }
  } impatient;
  CHECK_THROWS_AS(cpu::fast_polyhedron(fast_problem(mesh, 1e-9), 0)->at(points, impatient), Error);
}
