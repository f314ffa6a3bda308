// The stage `render` on every path: against the reference, batches, the budget of loop iterations, stopping.
#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/mesh/builtin.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "tests/support/compare_renders.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

// What a scene's spans show.
struct Shown {
  RawMesh mesh;
  std::vector<Vec3> normals;
  std::vector<Colour> colours;

  explicit Shown(RawMesh m, bool smooth = true, bool coloured = false) : mesh(std::move(m)) {
    if (smooth) normals = vertex_normals(mesh.vertices, mesh.faces);
    if (coloured)
      for (const Vec3& v : mesh.vertices)
        colours.push_back({float(0.5 + 0.4 * std::sin(3 * v.x())), float(0.5 + 0.4 * std::cos(5 * v.y())), 0.3F});
  }
  RenderSurface surface() const {
    RenderSurface s{mesh.vertices, mesh.faces, normals};
    s.vertex_colours = colours;
    return s;
  }
};

std::span<const Shown> one(const Shown& shown) {
  return std::span(&shown, 1);
}

RenderScene scene_of(std::span<const Shown> shown, int width, int height, View view) {
  RenderScene scene;
  scene.panel_width = width;
  scene.panel_height = height;
  for (const Shown& s : shown) {
    RenderPanel& panel = scene.panels.emplace_back();
    panel.view = view;
    panel.surfaces = {s.surface()};
    fit(panel, width, height);
  }
  return scene;
}

std::unique_ptr<Backend> gpu_with(std::uint32_t iteration_budget) {
  GpuOptions options;
  options.iteration_budget = iteration_budget;
  return gpu_backend(options);
}

} // namespace

TEST_CASE("pictures of every size are the reference's on every path, bit by bit the same on all", "[render][vulkan]") {
  Paths paths;
  std::vector<Shown> cow = {Shown(builtin_mesh("cow@0")), Shown(builtin_mesh("cow@0"), false),
                            Shown(torus(17, 9), true, true)};
  compare_renders(paths, scene_of(one(cow[0]), 1, 1, {50, 20}), 0);
  compare_renders(paths, scene_of(one(cow[0]), 7, 13, {50, 20}), 0);
  compare_renders(paths, scene_of(one(cow[1]), 65, 2, {50, 20}), 0);
  RenderScene grid = scene_of(cow, 31, 23, {33, 17});
  grid.columns = 2;
  compare_renders(paths, grid, 0);
  grid.transparent = true;
  compare_renders(paths, grid, 0);
}

TEST_CASE("surfaces through each other, seen along their sides, are the same on every path", "[render][vulkan]") {
  Paths paths;
  const Shown a(box({1, 1, 1}, {-0.5, -0.5, -0.5}), false), b(box({2, 0.3, 0.3}, {-1, -0.15, -0.15}), false),
      c(icosphere(2));
  RenderScene scene;
  scene.panel_width = scene.panel_height = 40;
  scene.panels.resize(1);
  scene.panels[0].surfaces = {a.surface(), b.surface(), c.surface()};
  Monitor silent;
  for (const View view : {View{0, 0}, View{90, 0}, View{0, 90}, View{45, 35.264389682754654}}) {
    scene.panels[0].view = view;
    fit(scene.panels[0], 40, 40);
    Image first;
    // Rays along faces and through edges: which of two faces is hit is for rounding to say, but the same on all paths.
    paths.each([&](Backend& backend) {
      const Image image = backend.render(scene, silent);
      if (first.rgba.empty()) first = image;
      CHECK(image.rgba == first.rgba);
    });
  }
}

TEST_CASE("a vertex's colour is what is seen there, and between them it goes over", "[render]") {
  RawMesh square;
  square.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  square.faces = {{0, 1, 2}, {0, 2, 3}};
  Shown shown(square, false);
  shown.colours = {{0.5F, 0, 0}, {0, 0, 0.5F}, {0, 0, 0.5F}, {0.5F, 0, 0}};
  const RenderScene scene = scene_of(one(shown), 64, 64, {0, 0});
  Monitor silent;
  const Image image = make_cpu_backend()->render(scene, silent);
  for (const int y : {8, 32, 56}) {
    CHECK(image.pixel(5, y)[0] > 2 * image.pixel(5, y)[2]);
    CHECK(image.pixel(58, y)[2] > 2 * image.pixel(58, y)[0]);
    for (int x = 6; x < 58; ++x) CHECK(image.pixel(x, y)[0] <= image.pixel(x - 1, y)[0]);
    CHECK(std::abs(int(image.pixel(32, y)[0]) - int(image.pixel(32, y)[2])) < 25);
  }
  RenderScene wrong = scene;
  wrong.panels[0].surfaces[0].vertex_colours = std::span(shown.colours).first(3);
  CHECK_THROWS_AS(make_cpu_backend()->render(wrong, silent), Error);
}

TEST_CASE("rays that the device gives up are followed on the host", "[render][vulkan]") {
  if (!gpu_backend()) return skip_without_gpu();
  const std::vector<Shown> cow = {Shown(builtin_mesh("cow@1"))};
  const RenderScene scene = scene_of(cow, 40, 30, {50, 20});
  Monitor silent;
  const Image image = make_cpu_backend()->render(scene, silent);
  for (const std::uint32_t budget : {5U, 60U, 300U}) {
    const auto gpu = gpu_with(budget);
    CHECK(gpu->render(scene, silent).rgba == image.rgba);
    CHECK(gpu->validation_messages() == std::vector<std::string>{});
  }
  try {
    gpu_with(4)->render(scene, silent);
    FAIL("a budget without a step was taken");
  } catch (const Error& error) {
    CHECK(error.fault() == Fault::too_large);
  }
}

TEST_CASE("render stops between batches and says how far it is", "[render][vulkan]") {
  class Stopping final : public Monitor {
  public:
    void progress(const char* what, double fraction) override {
      CHECK(std::string(what) == "render");
      CHECK((fraction > last && fraction <= 1));
      last = fraction;
    }
    bool stopped() const override { return ++asked > limit; }
    double last = 0;
    int limit = 1 << 30;
    mutable std::atomic<int> asked{0};
  };
  const std::vector<Shown> cow = {Shown(builtin_mesh("cow@0")), Shown(builtin_mesh("cow@0"))};
  const RenderScene scene = scene_of(cow, 600, 300, {50, 20});
  Paths paths;
  paths.each([&](Backend& backend) {
    Stopping monitor;
    backend.render(scene, monitor);
    CHECK(monitor.last > 0.5);
    Stopping early;
    early.limit = 2;
    try {
      backend.render(scene, early);
      FAIL("not stopped");
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::interrupted);
    }
    CHECK(early.last < 0.5);
  });
}

TEST_CASE("render --device writes the same picture on every device", "[cli][render][vulkan]") {
  if (!gpu_backend()) return skip_without_gpu();
  const TemporaryFolder folder;
  const auto drawn = [&](const std::string& device) {
    const std::string path = folder / (device + ".png");
    const ProgramRun run =
        run_program({"render", "builtin:cow@0", "-o", path, "--width", "60", "--height", "45", "--device", device});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return std::pair(run.err, read_file(path));
  };
  const auto cpu = drawn("cpu"), first = drawn("0");
  CHECK(cpu.second == first.second);
  CHECK_THAT(cpu.first, Catch::Contains("s on the CPU"));
  CHECK_THAT(first.first, !Catch::Contains("s on the CPU"));
}
