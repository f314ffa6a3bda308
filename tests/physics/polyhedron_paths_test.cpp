#include "host/error.hpp"
#include "tests/support/compare_polyhedron.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

constexpr double pi = std::numbers::pi;

// The sum of the diagonal.
double trace(const SymmetricTensor& h) {
  return h[0] + h[3] + h[5];
}

} // namespace

TEST_CASE("every path gives the reference's field at any number of points", "[polyhedron]") {
  Paths paths;
  const RawMesh mesh = torus(12, 8);
  for (const std::size_t count : {0, 1, 7, 13, 1025})
    for (const Derivatives derivatives : {Derivatives::none, Derivatives::first, Derivatives::second})
      compare_polyhedron(paths, polyhedron_problem(mesh, derivatives), points_about(mesh, count, 3 + unsigned(count)));
}

TEST_CASE("every path gives the reference's field of any body", "[polyhedron]") {
  Paths paths;
  std::mt19937 random(5);
  const RawMesh hull = convex_polyhedron(random, 60, 50);
  for (const RawMesh& mesh : {box({1, 2, 3}, {0.5, -1, 2}), tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}),
                              shell_with_cavity(), two_shells(), hull, flipped(box({1, 1, 1})),
                              scaled(icosphere(2), Vec3::Constant(1e9)), translated(icosphere(1), {1, 2, 3})})
    compare_polyhedron(paths, polyhedron_problem(mesh), points_about(mesh, 130, 11));
}

TEST_CASE("the field of a polyhedron has the same bits on any number of threads", "[polyhedron]") {
  const RawMesh mesh = icosphere(3);
  const PolyhedronProblem problem = polyhedron_problem(mesh);
  const auto points = points_about(mesh, 300, 2);
  const PolyhedronValues one = polyhedron(*make_cpu_backend(1), problem, points);
  for (const unsigned threads : {2, 5}) CHECK(same_bits(one, polyhedron(*make_cpu_backend(threads), problem, points)));
}

TEST_CASE("devices that run short loops sum the same field", "[polyhedron]") {
  GpuOptions options;
  options.iteration_budget = 100;
  const auto gpu = gpu_backend(options);
  if (!gpu) return skip_without_gpu();
  const RawMesh mesh = icosphere(2);
  const PolyhedronProblem problem = polyhedron_problem(mesh);
  const auto points = points_about(mesh, 70, 8);
  const PolyhedronValues short_loops = polyhedron(*gpu, problem, points),
                         other = polyhedron(*make_cpu_backend(), problem, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK(std::fabs(short_loops.field.value[i] / other.field.value[i] - 1) < 1e-14);
    CHECK((short_loops.field.gradient[i] - other.field.gradient[i]).norm() <
          1e-14 * std::max(1.0, other.field.gradient[i].norm()));
  }
}

TEST_CASE("second derivatives and the winding number have a side on faces", "[polyhedron]") {
  Paths paths;
  const RawMesh mesh = box({1, 1, 1});
  // Inside a triangle, and on the diagonal between two: no edge of the body.
  const std::vector<Vec3> points = {{0.3, 0.2, 1}, {0.25, 0.25, 1}, {0.5, 0.5, 0},
                                    {0, 0.3, 0.4}, {0.4, 0.4, 0.4}, {2, 2, 2}};
  paths.each([&](Backend& backend) {
    PolyhedronProblem problem = polyhedron_problem(mesh);
    const auto at = [&](FaceSide side) {
      problem.side = side;
      return polyhedron(backend, problem, points);
    };
    const PolyhedronValues mean = at(FaceSide::mean), outer = at(FaceSide::outer), inner = at(FaceSide::inner);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double on = i < 4 ? 1 : 0, inside = i < 4 ? 0.5 : i == 4 ? 1 : 0;
      CHECK(mean.on_edge[i] == 0);
      CHECK(std::fabs(mean.winding[i] - inside) < 1e-15);
      CHECK(std::fabs(outer.winding[i] - (inside - on / 2)) < 1e-15);
      CHECK(std::fabs(inner.winding[i] - (inside + on / 2)) < 1e-15);
      CHECK(std::fabs(trace(outer.field.hessian[i]) + 4 * pi * outer.winding[i]) < 1e-13);
      CHECK(std::fabs(trace(inner.field.hessian[i]) + 4 * pi * inner.winding[i]) < 1e-13);
      // The jump is along the normal alone.
      const std::size_t normal = i == 3 ? 0 : 5;
      for (std::size_t k = 0; k < 6; ++k)
        CHECK(std::fabs(outer.field.hessian[i][k] - inner.field.hessian[i][k] - (k == normal ? 4 * pi * on : 0)) <
              1e-13);
    }
  });
}

TEST_CASE("edges and corners are told where second derivatives are asked for", "[polyhedron]") {
  Paths paths;
  const RawMesh mesh = box({1, 1, 1});
  const std::vector<Vec3> points = {{0, 0, 0}, {0.5, 0, 0}, {1, 1, 0.25}, {0.5, 0.5, 0}, {0.5, -1e-9, 0}};
  paths.each([&](Backend& backend) {
    const PolyhedronValues found = polyhedron(backend, polyhedron_problem(mesh), points);
    CHECK(found.on_edge == std::vector<std::uint8_t>{1, 1, 1, 0, 0});
    CHECK(std::fabs(found.winding[0] - 0.125) < 1e-15);
    CHECK(std::fabs(found.winding[1] - 0.25) < 1e-15);
  });
}

TEST_CASE("points that are no numbers and bodies of no size are named", "[polyhedron]") {
  Paths paths;
  const RawMesh mesh = box({1, 1, 1}), tiny = scaled(mesh, Vec3::Constant(1e-200));
  paths.each([&](Backend& backend) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      const std::vector<Vec3> points = {{0, 0, 0}, {0, bad, 0}};
      CHECK_THROWS_WITH(polyhedron(backend, polyhedron_problem(mesh), points), Catch::Contains("point 1 is"));
    }
    const std::vector<Vec3> points = {{0, 0, 0}};
    CHECK_THROWS_WITH(polyhedron(backend, polyhedron_problem(tiny), points),
                      Catch::Contains("choose another length unit"));
    // No faces: no field.
    const PolyhedronValues none = polyhedron(backend, PolyhedronProblem{}, points);
    CHECK(none.field.value == std::vector<double>{0});
  });
}
