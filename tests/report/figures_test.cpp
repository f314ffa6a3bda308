#include "host/error.hpp"
#include "host/figures/figures.hpp"
#include "host/figures/mollweide.hpp"
#include "host/io/file.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

using namespace cowgpu;
using namespace cowgpu::figures;
using Catch::Contains;
using test::ProgramRun;
using test::run_program;
using test::TemporaryFolder;

TEST_CASE("Mollweide's projection keeps areas, and goes back", "[figures]") {
  CHECK(mollweide(M_PI / 2, M_PI).x == Approx(2).epsilon(1e-14));
  CHECK(mollweide(M_PI / 2, 0).x == 0);
  CHECK(mollweide(0, 1).y == Approx(1).epsilon(1e-14));
  CHECK(std::abs(mollweide(0, 1).x) < 1e-7);
  CHECK(mollweide(M_PI, 1).y == Approx(-1).epsilon(1e-14));
  double worst = 0;
  for (double theta = 0.02; theta < 3.13; theta += 0.1)
    for (double phi = -3.1; phi < 3.14; phi += 0.4) {
      double t = 0, p = 0;
      REQUIRE(from_mollweide(mollweide(theta, phi), t, p));
      worst = std::max({worst, std::abs(t - theta), std::abs(p - phi)});
      // The part of the sphere above theta is the part of the ellipse above y.
      const double y = mollweide(theta, 0).y, above = std::acos(y) - y * std::sqrt(1 - y * y);
      CHECK(above / M_PI == Approx((1 - std::cos(theta)) / 2).epsilon(1e-9));
    }
  CHECK(worst < 1e-9);
  double t = 0, p = 0;
  CHECK_FALSE(from_mollweide({2.01, 0}, t, p));
  CHECK_FALSE(from_mollweide({1.9, 0.5}, t, p));
}

TEST_CASE("a map of the sphere has its values where its directions are", "[figures]") {
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, 32);
  std::vector<double> values;
  for (int i = 0; i < grid.rings; ++i)
    for (int j = 0; j < grid.ring_length; ++j)
      values.push_back(std::sin(grid.theta[std::size_t(i)]) * std::sin(grid.phi(j)));
  plot::Canvas canvas(plot::PictureFormat::png, 220, 120);
  draw_mollweide(canvas, {10, 10, 200, 100}, grid, values, {-1, 1});
  const Image image = canvas.image();
  // Beside the lines of the graticule.
  for (const auto& [theta, phi] : {std::pair{1.4, 1.4}, {1.4, -1.4}, {0.9, 0.7}, {2.2, -2.3}, {2.0, 2.8}}) {
    const MapPoint at = mollweide(theta, phi);
    const std::uint8_t* pixel = image.pixel(int(3 * (110 + 50 * at.x)), int(3 * (60 - 50 * at.y)));
    const plot::Ink ink = plot::viridis(0.5 + 0.5 * std::sin(theta) * std::sin(phi));
    INFO(theta << " " << phi);
    CHECK(std::abs(pixel[0] - 255 * ink.r) < 6);
    CHECK(std::abs(pixel[1] - 255 * ink.g) < 6);
    CHECK(std::abs(pixel[2] - 255 * ink.b) < 6);
  }
  CHECK(int(image.pixel(3, 3)[0]) == 255);
}

TEST_CASE("a section is the cut's outline in the plane's own axes", "[figures]") {
  const RawMesh box = test::box({2, 4, 6}, {-1, -2, -3});
  Plane plane;
  plane.normal = Vec3::UnitX();
  plane.offset = 0.5;
  const auto lines = section(box, plane);
  REQUIRE(lines.size() == 1);
  for (const PlanePoint& p : lines[0])
    CHECK((std::abs(std::abs(p.u) - 2) < 1e-14 || std::abs(std::abs(p.v) - 3) < 1e-14));
  plane.offset = 7;
  CHECK(section(box, plane).empty());
}

TEST_CASE("spectra of nothing are refused, and there is a panel for each kind", "[figures]") {
  try {
    spectra_figure(plot::PictureFormat::png, {}, nullptr);
    FAIL("drawn");
  } catch (const Error& error) {
    CHECK(error.fault() == Fault::bad_argument);
  }
  Multipoles mass(4);
  std::fill(mass.values.begin(), mass.values.end(), 0.25);
  const plot::Canvas one = spectra_figure(plot::PictureFormat::png, {}, &mass);
  SurfaceExpansion expansion;
  expansion.coefficients = SphereCoefficients(4, 6);
  const NamedExpansion named{"nothing", &expansion};
  const plot::Canvas four = spectra_figure(plot::PictureFormat::png, std::span(&named, 1), &mass);
  CHECK(four.width() == 2 * one.width());
  CHECK(four.height() == 2 * one.height());
}

TEST_CASE("figure writes each figure, the same bytes again", "[cli][figures]") {
  const TemporaryFolder folder;
  struct Case {
    const char *name, *suffix;
    std::vector<std::string> more;
  };
  const std::vector<Case> cases = {{"spectra", ".png", {"--of", "mass,stretch", "--lmax", "12"}},
                                   {"spectra", ".svg", {"--of", "mass,stretch", "--lmax", "12"}},
                                   {"orders", ".png", {"--lmax", "8"}},
                                   {"components", ".png", {"--of", "harmonic", "--lmax", "8"}},
                                   {"definition", ".png", {"--lmax", "8"}},
                                   {"definition", ".svg", {"--lmax", "8"}},
                                   {"inflation", ".png", {}},
                                   {"streamlines", ".png", {"--count", "40"}},
                                   {"streamlines", ".svg", {"--count", "40", "--plane", "xy"}}};
  for (const Case& c : cases) {
    std::string bytes[2];
    // Level surfaces take long.
    const int times = std::string(c.name) == "inflation" ? 1 : 2;
    for (int i = 0; i < times; ++i) {
      const std::string path = folder / ("x" + std::to_string(i) + c.suffix);
      std::vector<std::string> arguments = {"figure", c.name, "builtin:cow@1", "-o", path, "--device", "cpu"};
      arguments.insert(arguments.end(), c.more.begin(), c.more.end());
      const ProgramRun run = run_program(arguments);
      INFO(c.name << ": " << run.err);
      REQUIRE(run.exit_code == 0);
      CHECK(run.out.empty());
      bytes[i] = read_file(path);
    }
    INFO(c.name << c.suffix);
    CHECK(bytes[0].size() > 5000);
    if (times == 2) CHECK(bytes[0] == bytes[1]);
    CHECK(bytes[0].substr(0, 5) == (std::string(c.suffix) == ".svg" ? "<?xml" : "\x89PNG\r"));
  }
}

TEST_CASE("figure refuses what it cannot draw, and writes nothing then", "[cli][figures]") {
  const TemporaryFolder folder;
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    std::string says;
  };
  const std::string png = folder / "x.png";
  const std::vector<Case> cases = {{{"gallery", "builtin:box", "-o", png}, 2, "gallery"},
                                   {{"spectra", "builtin:box"}, 2, "-o"},
                                   {{"spectra", "builtin:box", "-o", folder / "x.pdf"}, 2, "must end in .png or .svg"},
                                   {{"orders", "builtin:box", "-o", folder / "x.svg"}, 2, "must end in .png"},
                                   {{"orders", "builtin:box", "-o", png, "--of", "mass"}, 2, "one map"},
                                   {{"orders", "builtin:box", "-o", png, "--of", "milk"}, 2, "milk"},
                                   {{"streamlines", "builtin:box", "-o", png, "--plane", "1,0,0,9"}, 3, "misses"},
                                   {{"spectra", "builtin:teapot", "-o", png}, 2, "teapot"},
                                   {{"spectra", "builtin:box", "-o", folder / "none/x.png"}, 5, "cannot-write"}};
  for (const Case& c : cases) {
    std::vector<std::string> arguments = {"figure"};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const ProgramRun run = run_program(arguments);
    INFO(run.err);
    CHECK(run.exit_code == c.exit_code);
    CHECK_THAT(run.err, Contains(c.says));
    CHECK(std::filesystem::is_empty(folder.path()));
  }
}
