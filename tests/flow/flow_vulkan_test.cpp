// The Vulkan path of the verb `flow`: the CPU path's bits for all that may befall a point, wavefronts that are filled again,
// points that run out of turns, a wish to stop between passes, what the device did.
#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/spectrum/surface_distance.hpp"
#include "tests/support/compare_closest.hpp"
#include "tests/support/compare_flows.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

bool no_device() {
  if (gpu_backend()) return false;
  skip_without_gpu();
  return true;
}

FlowOptions forward(double time) {
  FlowOptions options;
  options.time = time;
  return options;
}

// A call on both paths, corners included, with nothing from the validation layer. Returns the device's report.
FlowReport check_as_on_cpu(const RawMesh& mesh, const std::vector<Vec3>& starts, FlowOptions options,
                           std::uint32_t iteration_budget = GpuOptions{}.iteration_budget,
                           const std::vector<Vec3>& normals = {}) {
  GpuOptions gpu_options;
  gpu_options.iteration_budget = iteration_budget;
  const auto gpu = gpu_backend(gpu_options);
  options.streamlines = true;
  Monitor silent;
  FlowReport found, expected;
  check_same(
      gpu->distance_flow(mesh.vertices, mesh.faces)->flow(starts, normals, options, silent, &found),
      make_cpu_backend()->distance_flow(mesh.vertices, mesh.faces)->flow(starts, normals, options, silent, &expected));
  CHECK((found.queries == expected.queries && found.events == expected.events && found.steps == expected.steps));
  if (options.backward) CHECK(found.device_moves == 0);
  // The host takes on points with a very long way.
  if (!options.backward && found.passes < 256) CHECK(found.device_moves == found.queries - found.points);
  CHECK(gpu->validation_messages() == std::vector<std::string>{});
  return found;
}

// A box round a cavity: flows in it meet up to eight sides, edges and corners and end in the middle.
RawMesh hollow(const RawMesh& cavity) {
  return together(box({6, 6, 6}, {-3, -3, -3}), flipped(cavity));
}

// As many starts as asked for all over the body's box and a bit more.
std::vector<Vec3> starts_about(const RawMesh& mesh, std::size_t count) {
  return queries_in_box(mesh, count, 1.3, std::uint32_t(count));
}

} // namespace

TEST_CASE("a flow of more points than are on their way at once is the CPU path's, and the device answered it",
          "[flow][vulkan]") {
  if (no_device()) return;
  const RawMesh mesh = two_balls(2, 1.3);
  const std::vector<Vec3> starts = area_samples(mesh.vertices, mesh.faces, 40013);
  Monitor silent;
  const auto gpu = gpu_backend();
  FlowReport report;
  const FlowPoints found =
      gpu->distance_flow(mesh.vertices, mesh.faces)->flow(starts, {}, forward(0.8), silent, &report);
  FlowReport on_cpu;
  check_same(
      found,
      make_cpu_backend()->distance_flow(mesh.vertices, mesh.faces)->flow(starts, {}, forward(0.8), silent, &on_cpu));
  CHECK(report.slid > 1000);
  CHECK(report.queries == on_cpu.queries);
  CHECK(report.events == on_cpu.events);
  CHECK(report.steps == on_cpu.steps);
  CHECK(report.device_queries > report.queries * 99 / 100);
  CHECK(report.device_queries <= report.queries);
  // From every answer but the first of each point the device went on by itself.
  CHECK(report.device_moves == report.queries - report.points);
  REQUIRE(report.kernels.size() == 3);
  double seconds = 0;
  const char* const names[] = {"closest", "flow", "flow_sheet"};
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(report.kernels[k].kernel == names[k]);
    CHECK((report.kernels[k].dispatches > report.passes / 2 && report.kernels[k].dispatches <= report.passes));
    CHECK(report.kernels[k].seconds > 0);
    seconds += report.kernels[k].seconds;
  }
  CHECK(report.seconds > seconds);
  CHECK((on_cpu.passes == 0 && on_cpu.device_queries == 0 && on_cpu.kernels.empty()));
  CHECK(gpu->validation_messages() == std::vector<std::string>{});
}

TEST_CASE("off bodies of all kinds flows on Vulkan have the CPU path's bits, forward and backward", "[flow][vulkan]") {
  if (no_device()) return;
  std::vector<RawMesh> bodies = {box({1, 2, 3}), tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}),
                                 two_balls(2, 0.8), hollow(box({2, 3, 3.5}, {-1, -1, -1})), hollow(icosphere(1))};
  for (const RawMesh& mesh : bodies)
    for (const std::size_t count : {0, 1, 7, 13, 1025}) {
      CAPTURE(mesh.faces.size(), count);
      const std::vector<Vec3> starts = starts_about(mesh, count);
      FlowOptions options = forward(0.7);
      const FlowReport report = check_as_on_cpu(mesh, starts, options);
      if (count > 1000 && mesh.faces.size() > 12) CHECK(report.slid > 40);
      options.backward = true;
      check_as_on_cpu(mesh, starts, options);
    }
}

TEST_CASE("points that meet many contacts, stand still or are left to the host have the CPU path's bits on Vulkan",
          "[flow][vulkan]") {
  if (no_device()) return;
  // About the middle of a ball more faces are equally near than a search lists.
  for (const RawMesh& cavity : {box({2, 2, 2}, {-1, -1, -1}), icosphere(1), icosphere(3)}) {
    const RawMesh mesh = hollow(cavity);
    std::vector<Vec3> starts;
    for (const Vec3& p : queries_in_box(cavity, 200, 0.5, 3)) starts.push_back(p);
    CAPTURE(cavity.faces.size());
    const FlowReport report = check_as_on_cpu(mesh, starts, forward(4));
    CHECK(report.stationary > 150);
    CHECK((report.device_queries < report.queries) == (cavity.faces.size() > 1000));
  }
}

TEST_CASE("the cows flow on Vulkan as on the CPU, at any tolerance and budget of loop iterations", "[flow][vulkan]") {
  if (no_device()) return;
  const RawMesh cow = load_mesh("builtin:cow");
  FlowOptions options = forward(0.4);
  for (const double tolerance : {1e-3, 1e-6, 1e-10}) {
    options.tolerance = tolerance;
    for (const std::uint32_t budget : {GpuOptions{}.iteration_budget, 2600U}) {
      CAPTURE(tolerance, budget);
      check_as_on_cpu(cow, area_samples(cow.vertices, cow.faces, 150), options, budget);
    }
  }
  const auto benchmark = benchmark_cow();
  if (!benchmark) return skip_without_cow();
  const RawMesh& mesh = benchmark->mesh();
  FlowReport report = check_as_on_cpu(mesh, area_samples(mesh.vertices, mesh.faces, 1025), forward(0.2));
  CHECK((report.slid > 800 && report.inside > 0));
  report = check_as_on_cpu(mesh, mesh.vertices, forward(0.2), GpuOptions{}.iteration_budget,
                           vertex_normals(mesh.vertices, mesh.faces));
  CHECK(report.slid > 2000);
}

TEST_CASE("a flow on Vulkan outlives its backend and takes starts inside, far away and on edges", "[flow][vulkan]") {
  if (no_device()) return;
  const RawMesh mesh = together(box({2, 2, 2}), box({2, 2, 2}, {1.5, 0.25, 0.25}));
  std::vector<Vec3> starts = mesh.vertices;
  std::vector<Vec3> normals = vertex_normals(mesh.vertices, mesh.faces);
  for (const Vec3& place : {Vec3(0.3, 1, 1), Vec3(1, 1, 0.4), Vec3(1.9, 1.2, 2), Vec3(1e7, 0, 0), Vec3(-3, 2, 1)}) {
    starts.push_back(place);
    normals.push_back(Vec3::Zero());
  }
  while (starts.size() < 700) {
    starts.push_back(starts[starts.size() - 21] + Vec3(0.01, 0.02, 0.005));
    normals.push_back(Vec3::Zero());
  }
  Monitor silent;
  auto gpu = gpu_backend();
  const auto flow = gpu->distance_flow(mesh.vertices, mesh.faces);
  gpu.reset();
  const auto cpu = make_cpu_backend()->distance_flow(mesh.vertices, mesh.faces);
  for (const double time : {0.0, 1e-9, 0.1, 2.0}) {
    FlowReport report;
    const FlowPoints found = flow->flow(starts, normals, forward(time), silent, &report);
    check_same(found, cpu->flow(starts, normals, forward(time), silent));
    CHECK(report.passes > 0);
    CHECK((report.inside > 0) == (time > 0));
  }
}

TEST_CASE("a wish to stop is heard between the passes of a flow", "[flow][vulkan]") {
  if (no_device()) return;
  const RawMesh mesh = two_balls(2, 1.3);
  const std::vector<Vec3> starts = area_samples(mesh.vertices, mesh.faces, 5000);
  struct StopLater : Monitor {
    int passes = 0;
    void progress(const char*, double fraction) override {
      ++passes;
      CHECK((fraction >= 0 && fraction <= 1));
    }
    bool stopped() const override { return passes == 3; }
  } monitor;
  const auto gpu = gpu_backend();
  const auto flow = gpu->distance_flow(mesh.vertices, mesh.faces);
  try {
    flow->flow(starts, {}, forward(2), monitor);
    FAIL("it went on");
  } catch (const Error& error) {
    CHECK(error.fault() == Fault::interrupted);
  }
  CHECK(monitor.passes == 3);
  Monitor silent; // and the flow is as good as new
  check_same(flow->flow(starts, {}, forward(0.5), silent),
             make_cpu_backend()->distance_flow(mesh.vertices, mesh.faces)->flow(starts, {}, forward(0.5), silent));
  CHECK(gpu->validation_messages() == std::vector<std::string>{});
}
