// The Vulkan path of the verb `closest`: batches, searches the device gives up, the budget of loop iterations. What both
// paths compute is held against the reference elsewhere.
#include "engine/kernels/closest.hpp"
#include "host/error.hpp"
#include "host/plan/closest_texels.hpp"
#include "tests/support/compare_closest.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <numbers>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

std::unique_ptr<Backend> gpu_with(std::uint32_t iteration_budget) {
  GpuOptions options;
  options.iteration_budget = iteration_budget;
  return gpu_backend(options);
}

bool no_device() {
  if (gpu_backend()) return false;
  skip_without_gpu();
  return true;
}

void check_same(const ClosestPoints& a, const ClosestPoints& b) {
  CHECK((a.distance == b.distance && a.point == b.point && a.face == b.face));
  CHECK((a.barycentric == b.barycentric && a.feature == b.feature && a.winding == b.winding));
}

// Of the CPU path, with nothing from the validation layer.
void check_as_on_cpu(const RawMesh& mesh, const std::vector<Vec3>& queries, std::uint32_t iteration_budget,
                     bool with_sign = true) {
  const auto gpu = gpu_with(iteration_budget);
  check_same(closest(*gpu, mesh, queries, with_sign), closest(*make_cpu_backend(), mesh, queries, with_sign));
  CHECK(gpu->validation_messages() == std::vector<std::string>{});
}

// A ball of 81920 faces, all of them at about the same distance from its middle, which has one closest point: whoever looks
// for it must look everywhere, and finds few candidates.
RawMesh rough_ball() {
  RawMesh mesh = icosphere(6);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(1, 1.002);
  for (Vec3& v : mesh.vertices) v *= uniform(random);
  mesh.vertices[0] *= 0.9995 / mesh.vertices[0].norm();
  return mesh;
}

constexpr std::uint32_t usual_budget = GpuOptions{}.iteration_budget;

} // namespace

TEST_CASE("closest points of several batches on Vulkan are the CPU path's, and the device found them",
          "[closest][vulkan]") {
  if (no_device()) return;
  const RawMesh mesh = torus(17, 9);
  const std::vector<Vec3> queries =
      queries_in_box(mesh, engine::closest_queries * engine::Closest::most_lanes + 13, 1.2, 1);
  const auto gpu = gpu_with(usual_budget);
  Monitor silent;
  ClosestReport report;
  const ClosestPoints found = gpu->distance_field(mesh.vertices, mesh.faces)->closest(queries, {}, silent, &report);
  check_same(found, closest(*make_cpu_backend(), mesh, queries));
  REQUIRE(report.kernels.size() == 1);
  CHECK(report.kernels[0].kernel == "closest");
  CHECK(report.kernels[0].dispatches == 2);
  CHECK(report.kernels[0].seconds > 0);
  CHECK(report.seconds > report.kernels[0].seconds);
  CHECK((report.rays > 0 && report.rays < queries.size()));
  CHECK(gpu->validation_messages() == std::vector<std::string>{});
}

TEST_CASE("a field on Vulkan outlives its backend and answers calls of any size in turn", "[closest][vulkan]") {
  if (no_device()) return;
  const RawMesh mesh = icosphere(3);
  auto gpu = gpu_with(usual_budget);
  const auto field = gpu->distance_field(mesh.vertices, mesh.faces);
  gpu.reset();
  const auto cpu = make_cpu_backend()->distance_field(mesh.vertices, mesh.faces);
  Monitor silent;
  for (const std::size_t count : {1, 5000, 0, 7, 5001}) {
    const std::vector<Vec3> queries = queries_near_surface(mesh, count, 0.05, std::uint32_t(count));
    check_same(field->closest(queries, {}, silent), cpu->closest(queries, {}, silent));
  }
}

TEST_CASE("more candidates than the device has room for are searched for on the host", "[closest][vulkan]") {
  if (no_device()) return;
  // Over the tip of a pyramid all its sides are equally near: 30 fit a lane, but not all lanes' the device's list; of 90
  // and of a ball about its middle there are too many for a lane.
  for (const std::uint32_t sides : {30U, 90U}) {
    RawMesh pyramid;
    pyramid.vertices.emplace_back(0, 0, 1);
    for (std::uint32_t k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      pyramid.vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
      pyramid.faces.push_back({0, k + 1, (k + 1) % sides + 1});
    }
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> uniform(-0.1, 0.1);
    std::vector<Vec3> queries(4001);
    for (Vec3& q : queries) q = {uniform(random), uniform(random), 1.5 + uniform(random)};
    check_as_on_cpu(pyramid, queries, usual_budget, false);
  }
  check_as_on_cpu(icosphere(4), std::vector<Vec3>(9, Vec3(1e-9, 0, 0)), usual_budget);
}

TEST_CASE("a list full of triangles that were near once is filtered and filled again", "[closest][vulkan]") {
  if (no_device()) return;
  // A lane with queries at both ends of a strip walks from one end to the other, nearer to the latter with every triangle.
  RawMesh strip;
  constexpr std::uint32_t faces = 300;
  for (std::uint32_t k = 0; k < faces + 2; ++k) strip.vertices.emplace_back(k, k % 2, 0);
  for (std::uint32_t k = 0; k < faces; ++k) strip.faces.push_back({k, k + 1, k + 2});
  const std::vector<Vec3> ends = {{-1, 0.2, 0.3}, {faces + 2.0, 0.7, 0.4}};
  check_as_on_cpu(strip, ends, usual_budget, false);

  const plan::ClosestTree tree(strip.vertices, strip.faces);
  const plan::ClosestTexels texels(tree);
  engine::Gpu gpu("auto", true);
  engine::Closest kernel(gpu.device(), {texels.nodes, texels.triangles, 2 * plan::closest_margin, usual_budget});
  const auto queries = kernel.queries(1);
  for (std::size_t k = 0; k < engine::closest_queries; ++k)
    for (std::size_t c = 0; c < 3; ++c) queries[engine::closest_queries * c + k] = tree.local(ends[k % 2])[c];
  kernel.search();
  REQUIRE(kernel.lanes()[0].candidates == 2);
  std::uint32_t found[2];
  for (const engine::ClosestCandidate c : kernel.candidates().subspan(kernel.lanes()[0].first, 2)) {
    REQUIRE((c.queries() == 5 || c.queries() == 10));
    found[c.queries() == 10] = tree.face_of_slot[texels.slots[c.triangle()]];
  }
  CHECK(found[0] == 0);
  CHECK(found[1] == faces - 1);
}

TEST_CASE("searches beyond the budget of loop iterations are finished on the host", "[closest][vulkan]") {
  if (no_device()) return;
  check_as_on_cpu(rough_ball(), std::vector<Vec3>(5, Vec3::Zero()), usual_budget);
  const RawMesh mesh = torus(90, 40);
  check_as_on_cpu(mesh, queries_in_box(mesh, 3000, 3, 1), 2500);
}

TEST_CASE("a budget of loop iterations that no search fits in is refused", "[closest][vulkan]") {
  if (no_device()) return;
  const RawMesh mesh = icosphere(1);
  CHECK_THROWS_WITH(gpu_with(0), Catch::Contains("iteration_budget"));
  for (const std::uint32_t budget : {1U, 100U, 1000U}) {
    try {
      closest(*gpu_with(budget), mesh, {{1, 2, 3}});
      FAIL("not refused");
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::too_large);
      CHECK_THAT(error.what(), Catch::Contains("loop iterations"));
    }
  }
}

TEST_CASE("a search that the device cuts short is an error, not an answer", "[closest][vulkan]") {
  if (no_device()) return;
  const RawMesh mesh = rough_ball();
  const plan::ClosestTree tree(mesh.vertices, mesh.faces);
  const plan::ClosestTexels texels(tree);
  engine::Gpu gpu("auto", true);
  const auto search = [&](std::uint32_t budget) {
    engine::Closest kernel(gpu.device(), {texels.nodes, texels.triangles, 2 * plan::closest_margin, budget});
    const auto local = tree.local(Vec3::Zero());
    const auto queries = kernel.queries(1);
    for (std::size_t i = 0; i < queries.size(); ++i) queries[i] = local[i / engine::closest_queries];
    kernel.search();
    return kernel.lanes()[0].candidates;
  };
  CHECK(search(usual_budget) == engine::closest_left);
  // More than software devices run; they end the loops where they like.
  try {
    const std::uint32_t candidates = search(1U << 30);
    CHECK((candidates > 0 && candidates < 10));
    CHECK(gpu.facts().type != "software");
  } catch (const engine::Error& error) {
    CHECK(error.failure() == engine::Failure::cut_short);
    CHECK_THAT(error.what(), Catch::Contains("ended a loop early"));
  }
  CHECK(gpu.validation_messages() == std::vector<std::string>{});
}
