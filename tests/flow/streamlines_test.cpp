#include "host/flow/streamlines.hpp"

#include "host/error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;

namespace {

double whole_length(const std::vector<CutLoop>& loops) {
  double length = 0;
  for (const CutLoop& loop : loops) length += loop.length;
  return length;
}

// Of the loops in the plane's axes, counter-clockwise positive.
double whole_area(const std::vector<CutLoop>& loops, const Plane& plane) {
  double area = 0;
  for (const CutLoop& loop : loops)
    for (std::size_t i = 0; i < loop.points.size(); ++i) {
      const Vec3 &a = loop.points[i], &b = loop.points[(i + 1) % loop.points.size()];
      area += (plane.u().dot(a) * plane.v().dot(b) - plane.u().dot(b) * plane.v().dot(a)) / 2;
    }
  return area;
}

Streamlines flow(const RawMesh& mesh, const StreamlineStarts& starts, const Vec3& origin, double time) {
  const auto backend = make_cpu_backend();
  const auto flow = backend->distance_flow(mesh.vertices, mesh.faces);
  FlowOptions options;
  options.time = time;
  Monitor monitor;
  return streamlines(mesh.vertices, mesh.faces, starts, origin, options, *flow, *backend, monitor);
}

} // namespace

TEST_CASE("planes are read by letters or numbers, with axes that turn to the normal", "[streamlines]") {
  const auto axes = [](const char* text, const Vec3& u, const Vec3& v) {
    const Plane plane = parse_plane(text);
    INFO(text);
    CHECK((plane.u() - u).norm() < 1e-15);
    CHECK((plane.v() - v).norm() < 1e-15);
    CHECK((plane.u().cross(plane.v()) - plane.normal.normalized()).norm() < 1e-15);
  };
  axes("yz", Vec3::UnitY(), Vec3::UnitZ());
  axes("xy", Vec3::UnitX(), Vec3::UnitY());
  axes("xz", Vec3::UnitX(), Vec3::UnitZ());
  axes("3,0,0,6", Vec3::UnitY(), Vec3::UnitZ());
  axes("0,-2,0,1", Vec3::UnitX(), Vec3::UnitZ());
  CHECK(parse_plane("3,0,0,6").height({5, 1, 1}) == 3);
  for (const char* bad : {"", "yx", "1,0,0", "1,0,0,", "1,0,0,1,2", "0,0,0,1", "1,nan,0,0", "1,0,0,2 "})
    CHECK_THROWS_AS(parse_plane(bad), Error);
}

TEST_CASE("the side of a plane is exact", "[streamlines]") {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> small(-1000, 1000);
  for (int i = 0; i < 2000; ++i) {
    const int n[3] = {small(random), small(random), small(random)},
              x[3] = {small(random), small(random), small(random)};
    const int dot = n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
    const double scale = std::ldexp(1.1, i % 40 - 20); // 1.1 times a whole number is no double
    const Plane through{Vec3(n[0], n[1], n[2]) * 0.1, 0};
    CHECK(Plane{Vec3(n[0], n[1], n[2]), double(dot)}.side(Vec3(x[0], x[1], x[2])) == 0);
    CHECK(Plane{Vec3(n[0], n[1], n[2]), std::nextafter(double(dot), 1e9)}.side(Vec3(x[0], x[1], x[2])) == -1);
    CHECK(Plane{Vec3(n[0], n[1], n[2]), std::nextafter(double(dot), -1e9)}.side(Vec3(x[0], x[1], x[2])) == 1);
    const long double value = (long double)(through.normal.x()) * (x[0] * scale) +
                              (long double)(through.normal.y()) * (x[1] * scale) +
                              (long double)(through.normal.z()) * (x[2] * scale);
    if (std::abs(double(value)) > 1e-12 * scale)
      CHECK(through.side(Vec3(x[0] * scale, x[1] * scale, x[2] * scale)) == (value > 0 ? 1 : -1));
  }
  // 1 + 2^-60 - 1: lost in double.
  CHECK(Plane{{1, std::ldexp(1, -60), 0}, 1}.side({1, 1, 0}) == 1);
  CHECK(Plane{{1, -std::ldexp(1, -60), 0}, 1}.side({1, 1, 0}) == -1);
}

TEST_CASE("the cut of a box is a rectangle of known length, wherever vertices and faces lie on the plane",
          "[streamlines]") {
  const RawMesh mesh = box({2, 3, 4}, {-1, -1, -1});
  struct Case {
    Plane plane;
    double length, area;
  };
  for (const Case& c : {Case{{Vec3::UnitX(), 0.3}, 14, 12}, Case{{-Vec3::UnitY(), 0}, 12, 8},
                        Case{{Vec3::UnitZ(), 0}, 10, 6}, Case{{Vec3::UnitZ(), 3}, 10, 6},          // the upper face
                        Case{{Vec3::UnitZ(), -1}, 10, 6},                                          // the lower one
                        Case{{Vec3(3, -2, 0), -1}, 2 * (4 + std::sqrt(13)), 4 * std::sqrt(13)}}) { // through two edges
    const auto loops = cut_by_plane(mesh.vertices, mesh.faces, c.plane);
    CAPTURE(c.plane.normal.transpose(), c.plane.offset);
    REQUIRE(loops.size() == 1);
    CHECK(loops[0].length == Approx(c.length).epsilon(1e-14));
    CHECK(whole_area(loops, c.plane) == Approx(c.area).epsilon(1e-14));
    REQUIRE(loops[0].faces.size() == loops[0].points.size());
    for (const Vec3& x : loops[0].points) CHECK(std::abs(c.plane.height(x)) < 4e-16);
  }
  CHECK(cut_by_plane(mesh.vertices, mesh.faces, {Vec3::UnitZ(), 3.1}).empty());
  CHECK(cut_by_plane(mesh.vertices, mesh.faces, {Vec3::UnitZ(), -1.1}).empty());
  CHECK(cut_by_plane(mesh.vertices, mesh.faces, {Vec3(1, 1, 1), 1 + 2 + 3}).empty()); // touches a corner
  RawMesh open = mesh;
  open.faces.pop_back();
  bool refused = false; // by one plane or another
  for (const Vec3& n : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) try {
      cut_by_plane(open.vertices, open.faces, {n, 0.3});
    } catch (const Error& error) {
      refused = true;
      CHECK(error.fault() == Fault::mesh_open);
    }
  CHECK(refused);
}

TEST_CASE("cuts of many bodies have the area and the length of their shape, cavities counted off", "[streamlines]") {
  const RawMesh two = together(box({6, 6, 6}), flipped(box({2, 3, 3.5}, {2, 1, 1})));
  const Plane plane{Vec3::UnitX(), 3};
  const auto loops = cut_by_plane(two.vertices, two.faces, plane);
  CHECK(loops.size() == 2);
  CHECK(whole_length(loops) == Approx(24 + 13).epsilon(1e-14));
  CHECK(whole_area(loops, plane) == Approx(36 - 10.5).epsilon(1e-14));
  // The polygon in a circle of radius sqrt(1 - h^2) misses it by the square of the edges.
  const RawMesh ball = icosphere(5);
  for (const double h : {0.0, 0.5}) {
    const Plane tilted{Vec3(1, 2, 3), h * std::sqrt(14)};
    const double radius = std::sqrt(1 - h * h);
    const auto circle = cut_by_plane(ball.vertices, ball.faces, tilted);
    REQUIRE(circle.size() == 1);
    CHECK(circle[0].length == Approx(2 * M_PI * radius).epsilon(2e-3));
    CHECK(whole_area(circle, tilted) == Approx(M_PI * radius * radius).epsilon(2e-3));
  }
}

TEST_CASE("starts are spaced evenly along the cut", "[streamlines]") {
  const RawMesh mesh = together(box({2, 2, 2}), box({1, 1, 1}, {5, 0.5, 0.5}));
  const Plane plane{Vec3::UnitZ(), 0.75};
  const auto loops = cut_by_plane(mesh.vertices, mesh.faces, plane);
  REQUIRE(loops.size() == 2);
  for (const std::size_t count : {1, 2, 7, 12, 1000}) {
    const StreamlineStarts starts = starts_along(loops, count, mesh.vertices, mesh.faces);
    CHECK(starts.places.size() == count);
    CHECK(starts.normals.size() == count);
    CHECK(starts.loops.size() == count);
    for (std::size_t i = 0; i < count; ++i) CHECK(plane.height(starts.places[i]) == 0);
  }
  // 12 a side length of 1: 8 along the larger square of length 8, 4 along the other.
  const StreamlineStarts starts = starts_along(loops, 12, mesh.vertices, mesh.faces);
  for (const std::uint32_t loop : {0U, 1U}) {
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < 12; ++i)
      if (starts.loops[i] == loop) places.push_back(starts.places[i]);
    CHECK(places.size() == std::size_t(std::lround(loops[loop].length)));
    for (std::size_t i = 0; i < places.size(); ++i) { // one apart in the norm of sums, round the corners too
      const Vec3 step = places[(i + 1) % places.size()] - places[i];
      CHECK(step.cwiseAbs().sum() == Approx(1).epsilon(1e-14));
    }
  }
}

TEST_CASE("streamlines of a box run straight along its normals, d the time", "[streamlines]") {
  const RawMesh mesh = box({2, 3, 4}, {-1, -1, -1});
  const Plane plane{Vec3::UnitX(), 0.25};
  const StreamlineStarts starts =
      starts_along(cut_by_plane(mesh.vertices, mesh.faces, plane), 57, mesh.vertices, mesh.faces);
  const Streamlines found = flow(mesh, starts, {0.25, 0, 0}, 5);
  CHECK(found.report.slid == 0);
  for (std::size_t i = 0; i < starts.places.size(); ++i) {
    const Vec3 end = starts.places[i] + 5 * starts.normals[i];
    CHECK(starts.normals[i].cwiseAbs().maxCoeff() == 1);
    CHECK(starts.normals[i].x() == 0);
    CHECK((found.lines.positions[i] - end).norm() < 1e-14);
    CHECK(found.lines.first[i + 1] - found.lines.first[i] == 2);
    CHECK((found.directions[i] - (end - Vec3(0.25, 0, 0)).normalized()).norm() < 1e-15);
    CHECK(std::hypot(found.directions[i].y(), found.directions[i].z()) == Approx(1).epsilon(1e-15));
    for (std::size_t k = found.lines.first[i]; k < found.lines.first[i + 1]; ++k)
      CHECK(std::abs(found.distances[k] - found.lines.path_times[k]) < 1e-14);
  }
}

TEST_CASE("streamlines of a ball are radial to the order of its triangles", "[streamlines]") {
  double before = 0;
  for (int level = 3; level <= 5; ++level) {
    const RawMesh mesh = icosphere(level);
    const Plane plane{Vec3(1, 2, 3), 0};
    const StreamlineStarts starts =
        starts_along(cut_by_plane(mesh.vertices, mesh.faces, plane), 300, mesh.vertices, mesh.faces);
    const Streamlines found = flow(mesh, starts, Vec3::Zero(), 3);
    CHECK(found.report.slid == 0);
    double turned = 0;
    for (std::size_t i = 0; i < starts.places.size(); ++i)
      turned += (found.directions[i] - starts.places[i].normalized()).norm() / double(starts.places.size());
    CAPTURE(level, turned);
    if (level > 3) CHECK(std::log2(before / turned) == Approx(1).margin(0.2)); // facets
    before = turned;
    // From the vertices the normals are those of the ball.
    const Streamlines exact = flow(mesh, starts_near(plane, 0.1, mesh.vertices, mesh.faces), Vec3::Zero(), 3);
    for (std::size_t i = 0; i < exact.directions.size(); ++i)
      CHECK((exact.directions[i] - exact.lines.path[exact.lines.first[i]].normalized()).norm() <
            1.4e-2 * std::pow(0.5, level - 3));
  }
}

TEST_CASE("off the benchmark's 116 vertices in its mirror plane distances never fall, and most lines keep to the plane",
          "[streamlines][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const RawMesh& mesh = cow->mesh();
  const Plane plane = parse_plane("xy");
  const StreamlineStarts starts = starts_near(plane, 0.001, mesh.vertices, mesh.faces);
  CHECK(starts.places.size() == 116);
  const Streamlines found = flow(mesh, starts, Vec3::Zero(), 3);
  CHECK(found.report.unfinished == 0);
  for (std::size_t i = 0; i < found.directions.size(); ++i)
    for (std::size_t k = found.lines.first[i] + 1; k < found.lines.first[i + 1]; ++k)
      CHECK(found.distances[k] >= found.distances[k - 1] - 1e-9);
  const auto kept = std::count_if(found.directions.begin(), found.directions.end(),
                                  [](const Vec3& direction) { return std::abs(direction.z()) < 0.05; });
  CHECK(kept >= 90);
  const auto loops = cut_by_plane(mesh.vertices, mesh.faces, plane);
  CHECK(whole_area(loops, plane) > 0);
  CHECK(starts_along(loops, 400, mesh.vertices, mesh.faces).places.size() == 400);
}

TEST_CASE("a line that ends at the origin has no direction, and the others keep theirs", "[streamlines]") {
  // Between two boxes the middle is a saddle of the distance.
  const RawMesh mesh = together(box({1, 1, 1}, {-4, -0.5, -0.5}), box({1, 1, 1}, {3, -0.5, -0.5}));
  StreamlineStarts starts;
  starts.places = {{-3, 0, 0}, {-4, 0, 0}};
  starts.normals = {{1, 0, 0}, {-1, 0, 0}};
  const auto backend = make_cpu_backend();
  const auto flow = backend->distance_flow(mesh.vertices, mesh.faces);
  Monitor monitor;
  FlowOptions options;
  options.time = 5;
  const Streamlines found =
      streamlines(mesh.vertices, mesh.faces, starts, Vec3::Zero(), options, *flow, *backend, monitor);
  CHECK((found.lines.flags[0] & flow_stationary) != 0);
  CHECK(found.lines.positions[0].norm() == 0);
  CHECK(found.directions[0].norm() == 0);
  CHECK((found.directions[1] + Vec3::UnitX()).norm() < 1e-12);
}

TEST_CASE("the command writes lines as CSV and JSON, and says why it cannot", "[streamlines]") {
  const TemporaryFolder folder;
  const auto call = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "streamlines");
    arguments.insert(arguments.end(), {"--device", "cpu"});
    return run_program(arguments);
  };
  const ProgramRun table = call({"builtin:box:2,2,2", "--count", "8", "--time", "1", "-o", "-"});
  INFO(table.err);
  REQUIRE(table.exit_code == 0);
  std::istringstream lines(table.out);
  std::vector<std::string> rows;
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with('#')) rows.push_back(line);
  REQUIRE(rows.size() == 1 + 16);
  CHECK(rows[0] == "line,time,x,y,z,u,v,height,distance,direction_u,direction_v,flags");
  CHECK_THAT(table.out, Contains("# axis_u 0,1,0\n# axis_v 0,0,1\n") && Contains("# mesh builtin:box:2,2,2"));
  const ProgramRun run = call({"builtin:box:2,2,2", "--spacing", "0.5", "--plane", "xz", "-o", folder / "lines.json"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("1 closed line of length 8") && Contains("16 points flowed, 0 slid"));
  const auto document = nlohmann::json::parse(std::ifstream(folder / "lines.json"));
  CHECK(document["lines"].size() == 16);
  CHECK(document["schema"] == "cowgpu.streamlines.v1");
  CHECK(document["lines"][0]["path"][1].size() == 7);

  const auto refuses = [&](std::vector<std::string> arguments, int code, const std::string& words) {
    arguments.insert(arguments.begin(), "builtin:box:2,2,2");
    const ProgramRun refused = call(arguments);
    INFO(refused.err);
    CHECK(refused.exit_code == code);
    CHECK_THAT(refused.err, Contains(words));
    CHECK(refused.out.empty());
  };
  refuses({"--plane", "1,0,0,7", "-o", folder / "none.csv"}, 3, "misses builtin:box:2,2,2");
  CHECK_FALSE(std::filesystem::exists(folder / "none.csv"));
  refuses({"--vertices", "0.5"}, 3, "no vertex of");
  refuses({"--plane", "zz"}, 2, "--plane zz");
  refuses({"--origin", "here"}, 2, "--origin here");
  refuses({"--count", "0"}, 2, "bad-argument");
  refuses({"--count", "5", "--spacing", "1"}, 2, "bad-argument");
  refuses({"--time", "-1"}, 2, "bad-argument");
  refuses({"-o", folder / "lines.nc"}, 2, "FILE.csv");
  refuses({"-o", "-", "--json"}, 2, "both write to the standard output");
  refuses({"-o", folder / "no/lines.csv"}, 5, "cannot-write");
}
