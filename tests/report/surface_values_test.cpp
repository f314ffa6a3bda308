// A quantity on a body, in colours: the figure and the page.
#include "host/figures/figures.hpp"

#include "host/backend.hpp"
#include "host/colour_scale.hpp"
#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/io/mesh_values_file.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;

namespace {

/// On a ball: its height, of faces or vertices.
MeshValues heights(ValuePlace place, int level = 2) {
  const RawMesh mesh = test::icosphere(level);
  MeshValues values{.title = "a ball", .place = place, .vertices = mesh.vertices, .faces = mesh.faces};
  values.places = mesh.vertices;
  if (place == ValuePlace::faces) {
    values.places.clear();
    for (const Face& f : mesh.faces)
      values.places.push_back((mesh.vertices[f[0]] + mesh.vertices[f[1]] + mesh.vertices[f[2]]) / 3);
  }
  ValueColumn height{"height", "m", "the height y", 1, {}}, other{"slope", "deg", "nothing", 1, {}};
  for (const Vec3& p : values.places) {
    height.values.push_back(p.y());
    other.values.push_back(0);
  }
  values.columns = {height, other};
  return values;
}

/// Hue of a pixel of the ball: how yellow it is against violet.
double yellow(const Image& image, int x, int y) {
  const std::uint8_t* p = image.pixel(x, y);
  return double(p[1]) - double(p[2]);
}

} // namespace

TEST_CASE("a figure of a quantity on a body has its high places yellow and its low ones violet", "[figures]") {
  const auto backend = make_cpu_backend();
  const View side{0, 0};
  for (const ValuePlace place : {ValuePlace::faces, ValuePlace::vertices}) {
    const plot::Canvas page = figures::surface_values_figure(plot::PictureFormat::png, heights(place), "height",
                                                             std::span(&side, 1), *backend, silent_monitor());
    const Image image = page.image();
    // The ball's middle is where the panel's is: margin 14, title 34, 1.6 times 216 by 168 points, three pixels each.
    const int x = int(3 * (14 + 0.8 * 216)), y = int(3 * (34 + 0.8 * 168)), r = int(3 * 0.8 * 168 * 0.8);
    CHECK(yellow(image, x, y - r) > 60);
    CHECK(yellow(image, x, y + r) < -20);
  }
}

TEST_CASE("a figure of a quantity on a body refuses points, unknown quantities and other meshes", "[figures]") {
  const auto backend = make_cpu_backend();
  const auto draw = [&](const MeshValues& values, const std::string& colour) {
    figures::surface_values_figure(plot::PictureFormat::svg, values, colour, {}, *backend, silent_monitor());
  };
  MeshValues points = heights(ValuePlace::vertices);
  points.place = ValuePlace::points;
  points.faces.clear();
  CHECK_THROWS_WITH(draw(points, ""), Contains("points without faces"));
  CHECK_THROWS_WITH(draw(heights(ValuePlace::faces), "tilt"), Contains("there are height, slope"));
}

TEST_CASE("figure and report show the values of a file on its mesh", "[cli][figures]") {
  const TemporaryFolder folder;
  const std::string table = folder / "ball.csv";
  write_mesh_values(table, heights(ValuePlace::faces));
  for (const char* suffix : {".png", ".svg"}) {
    std::string bytes[2];
    for (int i = 0; i < 2; ++i) {
      const std::string path = folder / (std::to_string(i) + suffix);
      const ProgramRun run = run_program({"figure", "surface", "builtin:sphere@2", "--values", table, "--colour",
                                          "height", "-o", path, "--device", "cpu"});
      INFO(run.err);
      REQUIRE(run.exit_code == 0);
      bytes[i] = read_file(path);
    }
    CHECK(bytes[0].size() > 5000);
    CHECK(bytes[0] == bytes[1]);
  }
  CHECK(run_program({"figure", "surface", "builtin:box@1", "-o", folder / "own.png", "--device", "cpu"}).exit_code ==
        0);
  const auto refused = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--device", "cpu"});
    const ProgramRun run = run_program(arguments);
    CHECK(run.exit_code != 0);
    return run.err;
  };
  const std::string png = folder / "x.png";
  CHECK_THAT(refused({"figure", "surface", "builtin:sphere@3", "--values", table, "-o", png}), Contains("computed on"));
  CHECK_THAT(refused({"figure", "surface", "builtin:sphere@2", "--values", table, "--colour", "g", "-o", png}),
             Contains("there are height, slope"));
  CHECK_THAT(refused({"figure", "inflation", "builtin:sphere@2", "--values", table, "-o", png}), Contains("'surface'"));
  CHECK_THAT(refused({"figure", "inflation", "builtin:sphere@2", "--view", "top", "--view", "side", "-o", png}),
             Contains("name one"));
}
