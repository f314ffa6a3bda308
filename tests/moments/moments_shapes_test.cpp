// Layouts, batches and threads of the stage `moments`: all of them right, and none of them felt in the bits where none
// should be.
#include "host/error.hpp"
#include "host/gpu/backend.hpp"
#include "host/reference/moments.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

constexpr double figure = 7e-14; // degrees whose norm is far below their bound

/// 150 groups of 8 pairs: more than two chunks of 64.
const RawMesh& body() {
  static const RawMesh mesh =
      rotated(torus(40, 30), Eigen::AngleAxisd(0.5, Vec3(1, 1, 0).normalized()).toRotationMatrix());
  return mesh;
}

MomentProblem body_problem(int lmax) {
  MomentProblem problem = moment_problem(body(), lmax);
  problem.cut_off = 0;
  return problem;
}

/// The Vulkan path in each of these layouts against the reference, at a few degrees.
void compare_shapes(const std::vector<GpuOptions>& shapes, std::initializer_list<int> degrees) {
  for (const int lmax : degrees) {
    const MomentProblem problem = body_problem(lmax);
    const auto reference = reference::moments<long double>(problem);
    for (const GpuOptions& shape : shapes) {
      const auto gpu = gpu_backend(shape);
      if (!gpu) return skip_without_gpu();
      INFO(fmt::format("{} levels, {} workgroups, rows in {}, {} bytes of state, {} iterations", shape.levels,
                       shape.workgroups, shape.rows_in_buffer ? "buffer" : "private memory", shape.state_budget,
                       shape.iteration_budget));
      compare_path(*gpu, problem, reference, figure);
      CHECK(gpu->validation_messages() == std::vector<std::string>{});
    }
  }
}

GpuOptions shape(std::uint32_t levels, std::uint32_t workgroups, bool rows_in_buffer) {
  GpuOptions options;
  options.levels = levels;
  options.workgroups = workgroups;
  options.rows_in_buffer = rows_in_buffer;
  return options;
}

} // namespace

TEST_CASE("the CPU path gives the same bits on any number of threads", "[moments][determinism]") {
  const MomentProblem problem = body_problem(120);
  const Multipoles one = moments(*make_cpu_backend(1), problem);
  for (const unsigned threads : {2U, 3U, 7U, 0U})
    for (int run = 0; run < 3; ++run) CHECK(same_bits(moments(*make_cpu_backend(threads), problem), one));
}

TEST_CASE("the Vulkan path gives the same bits run to run", "[moments][determinism]") {
  const MomentProblem problem = body_problem(120);
  Multipoles first;
  for (int instance = 0; instance < 2; ++instance) {
    const auto gpu = gpu_backend();
    if (!gpu) return skip_without_gpu();
    if (instance == 0) first = moments(*gpu, problem);
    for (int run = 0; run < 3; ++run) CHECK(same_bits(moments(*gpu, problem), first));
  }
}

TEST_CASE("the Vulkan path gives the same bits in small batches", "[moments][determinism]") {
  const RawMesh mesh = torus(25, 20); // 63 groups: one chunk
  MomentProblem problem = moment_problem(mesh, 120);
  for (const double cut_off : {0.0, default_cut_off}) {
    problem.cut_off = cut_off;
    Multipoles whole;
    for (const std::uint32_t budget : {60000U, 20000U, 2000U, 300U}) {
      GpuOptions options;
      options.iteration_budget = budget;
      const auto gpu = gpu_backend(options);
      if (!gpu) return skip_without_gpu();
      RunReport report;
      const Multipoles q = moments(*gpu, problem, &report);
      if (budget == 60000U) whole = q;
      INFO(budget);
      CHECK(same_bits(q, whole));
      std::uint64_t dispatches = 0;
      for (const KernelTime& kernel : report.kernels) dispatches += kernel.dispatches;
      if (budget == 300U) CHECK(dispatches > 60);
    }
  }
}

TEST_CASE("every number of levels gives the right moments", "[moments][shapes]") {
  std::vector<GpuOptions> shapes;
  for (const std::uint32_t levels : {2U, 4U, 8U, 16U})
    for (const bool rows_in_buffer : {false, true}) shapes.push_back(shape(levels, 0, rows_in_buffer));
  compare_shapes(shapes, {1, 9, 100});
}

TEST_CASE("a loop that the device ends early is an error, never a wrong result", "[moments][shapes][errors]") {
  const MomentProblem problem = body_problem(257);
  GpuOptions options;
  options.iteration_budget = 1000000000;
  const auto gpu = gpu_backend(options);
  if (!gpu) return skip_without_gpu();
  const Multipoles expected = moments(*make_cpu_backend(), problem);
  try {
    check_close(moments(*gpu, problem), expected, problem, figure); // a device without such a limit
  } catch (const Error& error) {
    CHECK(error.fault() == Fault::device_failed);
    CHECK(std::string(error.what()).find("ended a loop early") != std::string::npos);
  }
}

TEST_CASE("every number of workgroups gives the right moments", "[moments][shapes]") {
  std::vector<GpuOptions> shapes;
  for (const std::uint32_t workgroups : {1U, 2U, 8U, 64U})
    for (const bool rows_in_buffer : {false, true}) shapes.push_back(shape(0, workgroups, rows_in_buffer));
  compare_shapes(shapes, {60});
}

TEST_CASE("moments survive being cut into slices and chunks", "[moments][shapes]") {
  std::vector<GpuOptions> shapes;
  for (const std::uint32_t iterations : {1U, 300U, 2000U, 60000U})
    for (const std::uint64_t state : {std::uint64_t(1), std::uint64_t(512) << 20})
      for (const bool rows_in_buffer : {false, true}) {
        GpuOptions options = shape(0, 0, rows_in_buffer);
        options.iteration_budget = iterations;
        options.state_budget = state;
        shapes.push_back(options);
      }
  compare_shapes(shapes, {45});
}

TEST_CASE("slices end where groups are cut off, too", "[moments][shapes]") {
  // Shells of very different reach: each ends in another slice.
  RawMesh mesh = torus(9, 7);
  for (const double reach : {0.9, 0.7, 0.5, 0.3, 0.1, 0.01})
    mesh = together(mesh, translated(scaled(torus(9, 7), Vec3::Constant(reach / 2)), {0, 0, reach}));
  const MomentProblem problem = moment_problem(mesh, 150);
  const auto reference = reference::moments<long double>(problem);
  for (const std::uint32_t iterations : {500U, 3000U, 60000U})
    for (const bool rows_in_buffer : {false, true}) {
      GpuOptions options = shape(0, 2, rows_in_buffer);
      options.iteration_budget = iterations;
      const auto gpu = gpu_backend(options);
      if (!gpu) return skip_without_gpu();
      compare_path(*gpu, problem, reference, figure);
    }
}

TEST_CASE("layouts that no kernel has are refused in words, with or without a device", "[moments][shapes][errors]") {
  const auto with = [](auto&& set) {
    GpuOptions options;
    set(options);
    return options;
  };
  for (const auto& [wrong, word] : {
           std::pair(shape(1, 4, false), "levels is 1"),
           std::pair(shape(3, 4, false), "levels is 3"),
           std::pair(shape(32, 4, false), "levels is 32"),
           std::pair(shape(4, 3, false), "workgroups is 3"),
           std::pair(shape(4, 128, false), "workgroups is 128"),
           std::pair(shape(4, 4000000000U, false), "workgroups is 4000000000"),
           std::pair(with([](GpuOptions& o) { o.transform_steps = 12; }), "transform_steps is 12"),
           std::pair(with([](GpuOptions& o) { o.transform_steps = 72; }), "transform_steps is 72"),
           std::pair(with([](GpuOptions& o) { o.transform_rings = 16; }), "transform_rings is 16"),
           std::pair(with([](GpuOptions& o) { o.transform_pairs = 6; }), "transform_pairs is 6"),
           std::pair(with([](GpuOptions& o) { o.transform_pairs = 4000000000U; }), "transform_pairs is 4000000000"),
           std::pair(with([](GpuOptions& o) { o.iteration_budget = 0; }), "iteration_budget"),
           std::pair(with([](GpuOptions& o) { o.state_budget = 0; }), "state_budget"),
       }) {
    INFO(word);
    try {
      make_gpu_backend(wrong);
      FAIL("nothing was thrown");
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::bad_argument);
      CHECK_THAT(error.what(), Catch::Contains(word));
    }
  }
  CHECK_NOTHROW(gpu::check(with([](GpuOptions& o) { o.levels = 16, o.workgroups = 1, o.transform_pairs = 8192; })));
}
