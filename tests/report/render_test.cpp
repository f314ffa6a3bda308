#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/io/png.hpp"
#include "host/mesh/builtin.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <png.h>

#include <cstring>
#include <filesystem>
#include <fstream>

using namespace cowgpu;
using Catch::Contains;
using test::ProgramRun;
using test::run_program;
using test::TemporaryFolder;

namespace {

Image rendered(const RenderScene& scene, unsigned threads = 2) {
  Monitor silent;
  return make_cpu_backend(threads)->render(scene, silent);
}

/// One panel with one surface that fills it.
RenderScene scene_of(const RawMesh& mesh, const std::vector<Vec3>& normals, int width, int height, View view = {}) {
  RenderScene scene;
  scene.panel_width = width;
  scene.panel_height = height;
  scene.panels.resize(1);
  scene.panels[0].view = view;
  scene.panels[0].surfaces.push_back({mesh.vertices, mesh.faces, normals});
  fit(scene.panels[0], width, height);
  return scene;
}

double coverage(const Image& image) {
  double sum = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) sum += image.rgba[i] / 255.0;
  return sum;
}

double brightness(const Image& image, int x, int y) {
  const std::uint8_t* p = image.pixel(x, y);
  return (p[0] + p[1] + p[2]) / 3.0;
}

std::string fault_of(const RenderScene& scene) {
  try {
    rendered(scene);
  } catch (const Error& error) {
    return std::string(name(error.fault()));
  }
  return "none";
}

/// Pixels and format of a PNG file by libpng.
Image read_png(const std::string& bytes, bool& alpha) {
  png_image png;
  std::memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()));
  alpha = png.format & PNG_FORMAT_FLAG_ALPHA;
  png.format = PNG_FORMAT_RGBA;
  Image image(int(png.width), int(png.height));
  REQUIRE(png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr));
  return image;
}

std::string written(const Image& image) {
  const TemporaryFolder folder;
  AtomicFile file(folder / "x.png");
  write_png(image, file);
  file.commit();
  return read_file(folder / "x.png");
}

} // namespace

TEST_CASE("a ball's outline has the area of its disk", "[render]") {
  const RawMesh ball = test::icosphere(5);
  for (const View view : {View{0, 0}, View{37, 21}}) {
    RenderScene scene = scene_of(ball, {}, 200, 150, view);
    scene.transparent = true;
    const double pixels = 150 / scene.panels[0].height; // per unit
    const double expected = M_PI * pixels * pixels;
    const double found = coverage(rendered(scene));
    INFO(found << " of " << expected);
    CHECK(std::abs(found / expected - 1) < 6e-4);
    // 5 % of 150 pixels are left at the upper and the lower edge.
    CHECK(pixels == Approx((150 - 15) / 2.0).epsilon(1e-3));
  }
}

TEST_CASE("a rotated square's edges are anti-aliased to its area", "[render]") {
  RawMesh square;
  square.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  square.faces = {{0, 1, 2}, {0, 2, 3}};
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.3, Vec3::UnitZ()).toRotationMatrix();
  for (Vec3& v : square.vertices) v = turn * v;
  RenderScene scene = scene_of(square, {}, 100, 100);
  scene.transparent = true;
  scene.panels[0].centre = {0.0123, 0.0456, 0};
  const double expected = std::pow(2 * 100 / scene.panels[0].height, 2);
  CHECK(std::abs(coverage(rendered(scene)) / expected - 1) < 1e-4);
}

TEST_CASE("what is nearer hides what is behind it, from every side", "[render]") {
  const RawMesh box = test::box({1, 1, 1}, {-0.5, -0.5, -0.5});
  const Colour red = {0.6F, 0.02F, 0.02F}, blue = {0.02F, 0.02F, 0.6F};
  for (const char* name : {"side", "front", "back", "left", "top", "bottom", "iso", "-70,-35"}) {
    const View view = parse_view(name);
    const Vec3 eye = view.axes().row(2).transpose();
    const RawMesh near = test::translated(box, 1.5 * eye), far = test::translated(box, -1.5 * eye);
    RenderScene scene;
    scene.panel_width = scene.panel_height = 64;
    scene.panels.resize(1);
    scene.panels[0].view = view;
    scene.panels[0].surfaces = {{far.vertices, far.faces, {}, red}, {near.vertices, near.faces, {}, blue}};
    fit(scene.panels[0], 64, 64);
    INFO(name);
    const Image from_here = rendered(scene);
    CHECK(from_here.pixel(32, 32)[2] > 2 * from_here.pixel(32, 32)[0]);
    std::swap(scene.panels[0].surfaces[0].colour, scene.panels[0].surfaces[1].colour);
    const Image swapped = rendered(scene);
    CHECK(swapped.pixel(32, 32)[0] > 2 * swapped.pixel(32, 32)[2]);
  }
}

TEST_CASE("named views look from where they say", "[render]") {
  const auto eye = [](const char* name) { return Vec3(parse_view(name).axes().row(2)); };
  const auto right = [](const char* name) { return Vec3(parse_view(name).axes().row(0)); };
  CHECK(eye("side") == Vec3(0, 0, 1));
  CHECK(right("side") == Vec3(1, 0, 0)); // a cow looks to the right
  CHECK(eye("front") == Vec3(1, 0, 0));
  CHECK(eye("back") == Vec3(-1, 0, 0));
  CHECK(eye("left") == Vec3(0, 0, -1));
  CHECK(eye("top") == Vec3(0, 1, 0));
  CHECK(right("top") == Vec3(1, 0, 0));
  CHECK(eye("bottom") == Vec3(0, -1, 0));
  CHECK((eye("iso") - Vec3(1, 1, 1) / std::sqrt(3.0)).norm() < 1e-15);
  for (const char* name : {"iso", "12.5,-33", "-360,90"}) {
    const Eigen::Matrix3d axes = parse_view(name).axes();
    CHECK((axes * axes.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-15);
    CHECK(axes.determinant() == Approx(1).epsilon(1e-15));
  }
  for (const char* wrong : {"", "sideways", "1", "1,", ",1", "1,2,3", "361,0", "0,91", "nan,0", "1;2"}) {
    INFO(wrong);
    CHECK_THROWS_AS(parse_view(wrong), Error);
  }
}

TEST_CASE("light comes from the upper left, and less of it into corners", "[render]") {
  const RawMesh ball = test::icosphere(5);
  const auto normals = vertex_normals(ball.vertices, ball.faces);
  const Image image = rendered(scene_of(ball, normals, 100, 100));
  CHECK(brightness(image, 30, 30) > brightness(image, 70, 30) + 10);
  CHECK(brightness(image, 30, 30) > brightness(image, 30, 70) + 10);
  CHECK(brightness(image, 70, 30) > brightness(image, 70, 70));

  // A floor, seen from above, with a wall on the right: bright far from the wall, darker beside it.
  const RawMesh corner = test::together(test::box({4, 0.1, 4}, {-4, -0.1, -2}), test::box({0.1, 2, 4}, {0, -0.1, -2}));
  const Image floor = rendered(scene_of(corner, {}, 110, 110, parse_view("top")));
  const double far_away = brightness(floor, 30, 55), beside = brightness(floor, 97, 55);
  INFO(far_away << " " << beside);
  CHECK(far_away > beside + 10);
  for (int x = 20; x < 95; x += 5) CHECK(brightness(floor, x, 55) >= brightness(floor, x + 5, 55) - 1);
}

TEST_CASE("the picture does not depend on the threads, on the orientation of faces, nor on scale", "[render]") {
  const RawMesh cow = builtin_mesh("cow@1");
  const auto normals = vertex_normals(cow.vertices, cow.faces);
  const Image image = rendered(scene_of(cow, normals, 150, 100, {50, 20}), 1);
  CHECK(rendered(scene_of(cow, normals, 150, 100, {50, 20}), 3).rgba == image.rgba);

  const auto close = [&](const Image& other) {
    int worst = 0;
    for (std::size_t i = 0; i < image.rgba.size(); ++i)
      worst = std::max(worst, std::abs(int(image.rgba[i]) - int(other.rgba[i])));
    return worst <= 1;
  };
  const RawMesh inside_out = test::flipped(cow);
  CHECK(
      close(rendered(scene_of(inside_out, vertex_normals(inside_out.vertices, inside_out.faces), 150, 100, {50, 20}))));
  for (const double factor : {1e-40, 0x1p100}) {
    const RawMesh other = test::scaled(cow, Vec3::Constant(factor));
    INFO(factor);
    CHECK(close(rendered(scene_of(other, vertex_normals(other.vertices, other.faces), 150, 100, {50, 20}))));
  }
}

TEST_CASE("panels are the pictures they would be alone, row by row", "[render]") {
  const RawMesh cow = builtin_mesh("cow@0"), box = test::box({1, 2, 3});
  RenderScene scene = scene_of(cow, {}, 70, 50);
  scene.columns = 2;
  const View views[] = {{0, 0}, {90, 0}, {20, 30}};
  const RawMesh* meshes[] = {&cow, &box, &cow};
  scene.panels.clear();
  std::vector<Image> alone;
  for (int i = 0; i < 3; ++i) {
    const RenderScene one = scene_of(*meshes[i], {}, 70, 50, views[i]);
    scene.panels.push_back(one.panels[0]);
    alone.push_back(rendered(one));
  }
  const Image all = rendered(scene);
  REQUIRE(all.width == 140);
  REQUIRE(all.height == 100);
  for (int i = 0; i < 4; ++i)
    for (int y = 0; y < 50; ++y) {
      const std::uint8_t* row = all.pixel(i % 2 * 70, i / 2 * 50 + y);
      if (i < 3)
        CHECK(std::memcmp(row, alone[std::size_t(i)].pixel(0, y), 4 * 70) == 0);
      else
        CHECK(std::all_of(row, row + 4 * 70, [](std::uint8_t c) { return c == 255; }));
    }
}

TEST_CASE("scenes that cannot be shown are refused", "[render]") {
  const RawMesh box = test::box({1, 1, 1});
  const RenderScene good = scene_of(box, {}, 20, 20);
  CHECK(fault_of(good) == "none");
  RenderScene bad = good;
  bad.panels.clear();
  CHECK(fault_of(bad) == "bad-argument");
  bad = good;
  bad.panel_width = 0;
  CHECK(fault_of(bad) == "bad-argument");
  bad.panel_width = largest_picture + 1;
  CHECK(fault_of(bad) == "bad-argument");
  bad = good;
  bad.columns = 0;
  CHECK(fault_of(bad) == "bad-argument");
  bad = good;
  bad.panels[0].height = 0;
  CHECK(fault_of(bad) == "bad-argument");
  bad = good;
  bad.panels[0].surfaces.clear();
  CHECK(fault_of(bad) == "mesh-empty");
  const std::vector<Face> wrong = {{0, 1, 8}};
  bad = good;
  bad.panels[0].surfaces[0].faces = wrong;
  CHECK(fault_of(bad) == "mesh-index-range");
  std::vector<Vec3> infinite = box.vertices;
  infinite[3].z() = HUGE_VAL;
  bad = good;
  bad.panels[0].surfaces[0].vertices = infinite;
  CHECK(fault_of(bad) == "mesh-not-finite");
  bad = good;
  bad.panels[0].surfaces[0].normals = std::span(infinite).first(7);
  CHECK(fault_of(bad) == "bad-argument");
}

TEST_CASE("PNG files hold the pixels, in sRGB, with alpha only where it says something", "[png]") {
  const RawMesh ball = test::icosphere(2);
  RenderScene scene = scene_of(ball, {}, 37, 23);
  for (const bool transparent : {false, true}) {
    scene.transparent = transparent;
    const Image image = rendered(scene);
    const std::string bytes = written(image);
    bool alpha = false;
    const Image read = read_png(bytes, alpha);
    CHECK(alpha == transparent);
    CHECK(read.width == 37);
    CHECK(read.height == 23);
    CHECK(read.rgba == image.rgba);
    CHECK(bytes.find("sRGB") != std::string::npos);
    CHECK(written(image) == bytes);
  }
  CHECK_THROWS_AS(written(Image()), Error);
}

TEST_CASE("render writes a picture of a mesh", "[cli][render]") {
  const TemporaryFolder folder;
  const ProgramRun run = run_program({"render", "builtin:cow@1", "-o", folder / "cow.png", "--width", "80", "--height",
                                      "60", "--view", "side", "--view", "30,20", "--transparent", "--device", "cpu"});
  INFO(run.err);
  CHECK(run.exit_code == 0);
  CHECK(run.out.empty());
  CHECK_THAT(run.err, Contains("wrote " + (folder / "cow.png") + ": 160 x 60 pixels"));
  bool alpha = false;
  const Image image = read_png(read_file(folder / "cow.png"), alpha);
  CHECK(alpha);
  CHECK(image.width == 160);
  CHECK(image.height == 60);
  CHECK(image.pixel(0, 0)[3] == 0);
  CHECK(coverage(image) > 1000);

  CHECK(
      run_program({"render", "-o", folder / "flat.png", "--width", "40", "--height", "30", "--flat", "-q"}).exit_code ==
      0);
  const Image flat = read_png(read_file(folder / "flat.png"), alpha);
  CHECK_FALSE(alpha);
  CHECK(flat.width == 40);
}

TEST_CASE("render shows the body at its orders in panels of one scale, from a mesh as from a result file",
          "[cli][render]") {
  const TemporaryFolder folder;
  const std::vector<std::string> size = {"--width", "60", "--height", "45", "--device", "cpu"};
  const auto render = [&](const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), size.begin(), size.end());
    arguments.insert(arguments.end(), {"-o", folder / name});
    const ProgramRun run = run_program(arguments);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return read_file(folder / name);
  };
  const auto picture = [](const std::string& bytes) {
    bool alpha = false;
    return read_png(bytes, alpha);
  };
  REQUIRE(run_program({"expand", "builtin:cow@1", "--of", "stretch,smooth", "--lmax", "6", "--device", "cpu", "-q",
                       "-o", folder / "cow.json"})
              .exit_code == 0);
  const std::string six = render("six.png", {folder / "cow.json"});
  CHECK(six == render("mesh.png", {"builtin:cow@1", "--order", "6", "--lmax", "6"}));
  CHECK(six != render("smooth.png", {folder / "cow.json", "--of", "smooth"}));
  CHECK(six != render("f.png", {folder / "cow.json", "--fields", "f"}));
  CHECK(six != render("five.png", {folder / "cow.json", "--order", "5"}));

  const Image row = picture(render("row.png", {folder / "cow.json", "--order", "0,1", "--order", "6"}));
  CHECK(row.width == 180);
  CHECK(row.height == 45);
  const Image square =
      picture(render("square.png", {folder / "cow.json", "--order", "0..6,mesh", "--mesh", "builtin:cow@1"}));
  CHECK(square.width == 180);
  CHECK(square.height == 135);
  const Image table =
      picture(render("table.png", {"--order", "3,mesh", "--view", "side", "--view", "top", "--view", "front"}));
  CHECK(table.width == 120);
  CHECK(table.height == 135);
  const Image column = picture(render("column.png", {"--order", "3,mesh", "--columns", "1"}));
  CHECK(column.width == 60);
  CHECK(column.height == 90);
  // The panel of the mesh is the mesh's own picture: the sphere beside it is smaller than the cow is long.
  const std::string alone = render("alone.png", {"builtin:cow@1"});
  const Image own = picture(alone), both = picture(render("both.png", {"builtin:cow@1", "--order", "0,mesh"}));
  CHECK(std::abs(double(coverage(both)) / double(coverage(own)) - 1) > 0.2);
  double difference = 0;
  for (int y = 0; y < own.height; ++y)
    for (int x = 0; x < own.width; ++x)
      difference = std::max(difference, std::abs(double(own.pixel(x, y)[1]) - double(both.pixel(x + 60, y)[1])));
  CHECK(difference == 0);
}

TEST_CASE("render refuses what it cannot do, and writes nothing then", "[cli][render]") {
  const TemporaryFolder folder;
  std::ofstream(folder / "open.off") << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  std::ofstream(folder / "nan.off") << "OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n";
  std::ofstream(folder / "empty.off") << "OFF\n0 0 0\n";
  std::ofstream(folder / "mass.json") << R"({"schema": "cowgpu.result.v1", "expansions": {"mass": {}}})";
  const std::string png = folder / "x.png";
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    std::string says;
  };
  const std::vector<Case> cases = {
      {{"builtin:box"}, 2, "-o"},
      {{"builtin:box", "-o", folder / "x.jpg"}, 2, "must end in .png"},
      {{"builtin:box", "-o", ".png"}, 2, "must end in .png"},
      {{"builtin:box", "-o", png, "--view", "sideways"}, 2, "iso"},
      {{"builtin:box", "-o", png, "--view", "0,91"}, 2, "elevation"},
      {{"builtin:box", "-o", png, "--width", "0"}, 2, "--width"},
      {{"builtin:box", "-o", png, "--height", "100000"}, 2, "--height"},
      {{"builtin:box", "-o", png, "--width", "9000", "--view", "side", "--view", "top"}, 2, "16384"},
      {{"builtin:teapot", "-o", png}, 2, "teapot"},
      {{folder / "none.off", "-o", png}, 5, "cannot-read"},
      {{folder / "nan.off", "-o", png}, 3, "mesh-not-finite"},
      {{folder / "empty.off", "-o", png}, 3, "mesh-empty"},
      {{"builtin:box", "-o", folder / "no folder/x.png"}, 5, "cannot-write"},
      {{"builtin:box", "-o", "/dev/full", "-q"}, 2, "must end in .png"},
      {{"builtin:box", "-o", png, "--order", "-1"}, 2, "--order"},
      {{"builtin:box", "-o", png, "--order", "0..9999"}, 2, "not an order"},
      {{"builtin:box", "-o", png, "--order", "milk"}, 2, "not an order"},
      {{"builtin:box", "-o", png, "--order", "9", "--lmax", "8"}, 2, "beyond --lmax 8"},
      {{"builtin:box", "-o", png, "--fields", "f"}, 2, "add --order"},
      {{"builtin:box", "-o", png, "--of", "stretch"}, 2, "add --order"},
      {{folder / "mass.json", "-o", png}, 3, "no expansion of a surface"},
      {{folder / "none.json", "-o", png}, 5, "cannot-read"},
  };
  for (const Case& c : cases) {
    std::vector<std::string> arguments = {"render"};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const ProgramRun run = run_program(arguments);
    INFO(run.err);
    CHECK(run.exit_code == c.exit_code);
    CHECK_THAT(run.err, Contains(c.says));
    CHECK_FALSE(std::filesystem::exists(png));
  }
  CHECK(run_program({"render", folder / "open.off", "-o", png, "--width", "30", "--height", "20"}).exit_code == 0);
  CHECK(std::filesystem::exists(png));
}
