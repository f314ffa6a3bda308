#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/mesh/builtin.hpp"
#include "host/plan/polyhedron_settings.hpp"
#include "tests/support/compare_polyhedron.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/polyhedron_errors.hpp"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

// With translations on the host, where a software device leaves them, and on the device.
std::vector<std::unique_ptr<Backend>> devices() {
  std::vector<std::unique_ptr<Backend>> found;
  for (const bool translations : {false, true}) {
    GpuOptions options;
    options.validation = true;
    options.translations = translations;
    if (auto gpu = gpu_backend(options)) found.push_back(std::move(gpu));
  }
  return found;
}

void check_tolerance(Backend& gpu, const RawMesh& mesh, const std::vector<Vec3>& points, const PolyhedronValues& truth,
                     double tolerance, bool guarantee, double value_part = 1) {
  const PolyhedronProblem asked = fast_problem(mesh, tolerance, Derivatives::first, guarantee);
  REQUIRE(plan::fast_sum_pays(asked, points.size()));
  const FieldErrors found = field_errors(mesh, polyhedron(gpu, asked, points), truth);
  INFO("tolerance " << tolerance << ", " << mesh.faces.size() << " faces, guarantee " << guarantee);
  CHECK(found.gradient < tolerance);
  CHECK(found.value < tolerance * value_part);
  CHECK(found.winding < 1000 * tolerance);
  if (!guarantee) return;
  CHECK(found.bound <= tolerance);
  CHECK(found.bounded);
}

} // namespace

TEST_CASE("the fast sum on a device keeps its tolerance at every face, and bounds hold", "[polyhedron_fast][vulkan]") {
  if (!gpu_backend()) return skip_without_gpu();
  const RawMesh mesh = builtin_mesh("cow@1");
  const std::vector<Vec3> points = centroids(mesh);
  const PolyhedronValues truth = polyhedron(*make_cpu_backend(), fast_problem(mesh, 0), points);
  for (const auto& gpu : devices()) {
    check_tolerance(*gpu, mesh, points, truth, 1e-6, false);
    check_tolerance(*gpu, mesh, points, truth, 1e-9, true);
    check_tolerance(*gpu, mesh, points, truth, 1e-12, false);
    CHECK(gpu->validation_messages() == std::vector<std::string>{});
  }
}

TEST_CASE("the fast sum on a device keeps its tolerance at every face of a larger body",
          "[polyhedron_fast][vulkan][long]") {
  if (!gpu_backend()) return skip_without_gpu();
  const RawMesh mesh = builtin_mesh("asteroid:1@5");
  const std::vector<Vec3> points = centroids(mesh);
  const PolyhedronValues truth = polyhedron(*make_cpu_backend(), fast_problem(mesh, 0), points);
  for (const auto& gpu : devices())
    for (const bool guarantee : {false, true}) check_tolerance(*gpu, mesh, points, truth, 1e-9, guarantee);
}

TEST_CASE("the fast sum on a device keeps its tolerance on thin, hollow, star-shaped and distant bodies",
          "[polyhedron_fast][vulkan]") {
  if (!gpu_backend()) return skip_without_gpu();
  const auto scaled_by = [](const Vec3& axes) {
    RawMesh mesh = icosphere(3);
    for (Vec3& v : mesh.vertices) v = v.cwiseProduct(axes);
    return mesh;
  };
  RawMesh star = icosphere(3);
  for (Vec3& v : star.vertices) v *= 1 + 0.6 * std::sin(9 * v.x()) * std::sin(7 * v.y());
  const RawMesh hollow = together(icosphere(3), flipped(scaled_by(Vec3::Constant(0.99))));
  for (const RawMesh& mesh : {scaled_by({1, 1, 1e-6}), scaled_by({1, 1e-3, 1e-3}), hollow, star,
                              translated(icosphere(3), {1e5, -2e4, 3e4})}) {
    const std::vector<Vec3> points = centroids(mesh);
    const PolyhedronValues truth = polyhedron(*make_cpu_backend(), fast_problem(mesh, 0), points);
    // Errors of V are parts of v/R, and allowed in proportion to the body's radius.
    Vec3 middle = Vec3::Zero();
    for (const Vec3& v : mesh.vertices) middle += v / double(mesh.vertices.size());
    double radius = 0, volume = 0;
    for (const Vec3& v : mesh.vertices) radius = std::max(radius, (v - middle).norm());
    for (const Face& f : mesh.faces)
      volume +=
          (mesh.vertices[f[0]] - middle).dot((mesh.vertices[f[1]] - middle).cross(mesh.vertices[f[2]] - middle)) / 6;
    const double part = radius / std::cbrt(0.75 * volume * std::numbers::inv_pi);
    for (const auto& gpu : devices()) {
      check_tolerance(*gpu, mesh, points, truth, 1e-6, true, part);
      check_tolerance(*gpu, mesh, points, truth, 1e-9, false, part);
    }
  }
}

TEST_CASE("the fast sum on a device is right inside, far away, on vertices, and gives second derivatives",
          "[polyhedron_fast][vulkan]") {
  if (!gpu_backend()) return skip_without_gpu();
  const RawMesh mesh = builtin_mesh("cow@1");
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points = mesh.vertices;
  for (int i = 0; i < 3000; ++i) points.emplace_back(normal(random), normal(random), normal(random));
  for (const double d : {3.0, 30.0, 1e3, 1e6, 1e12, 1e40}) points.emplace_back(0.6 * d, 0.64 * d, 0.48 * d);
  const PolyhedronProblem asked = fast_problem(mesh, 1e-9, Derivatives::second);
  REQUIRE(plan::fast_sum_pays(asked, points.size()));
  const PolyhedronValues truth = polyhedron(*make_cpu_backend(), fast_problem(mesh, 0, Derivatives::second), points);
  for (const auto& gpu : devices()) {
    const PolyhedronValues found = polyhedron(*gpu, asked, points);
    const FieldErrors worst = field_errors(mesh, found, truth);
    CHECK(worst.gradient < 1e-9);
    CHECK(worst.value < 1e-9);
    CHECK(worst.hessian < 1e-7);
    CHECK(found.on_edge == truth.on_edge);
    CHECK(same_bits(found, polyhedron(*gpu, asked, points)));
    CHECK(gpu->validation_messages() == std::vector<std::string>{});
  }
}

TEST_CASE("the fast sum on a device stops when it is asked to", "[polyhedron_fast][vulkan]") {
  if (!gpu_backend()) return skip_without_gpu();
  const RawMesh mesh = builtin_mesh("cow@1");
  const std::vector<Vec3> points = centroids(mesh);
  struct : Monitor {
    bool stopped() const override { return true; }
  } impatient;
  for (const auto& gpu : devices())
    CHECK_THROWS_AS(gpu->polyhedron(fast_problem(mesh, 1e-9))->at(points, impatient), Error);
}
