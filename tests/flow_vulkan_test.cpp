// The Vulkan path of the verb `flow`: wavefronts that are filled again, a wish to stop between passes, what the device did.
// That both paths give the same bits at odd sizes stands in flow_test.cpp.
#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/spectrum/surface_distance.hpp"
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
  REQUIRE(report.kernels.size() == 1);
  CHECK(report.kernels[0].kernel == "closest");
  CHECK(report.kernels[0].dispatches == report.passes);
  CHECK(report.kernels[0].seconds > 0);
  CHECK(report.seconds > report.kernels[0].seconds);
  CHECK((on_cpu.passes == 0 && on_cpu.device_queries == 0 && on_cpu.kernels.empty()));
  CHECK(gpu->validation_messages() == std::vector<std::string>{});
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
