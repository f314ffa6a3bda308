#include "host/physics/magnetisation.hpp"

#include "host/mesh/builtin.hpp"
#include "host/mesh/geometry.hpp"
#include "host/physics/polyhedron.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::physics;
using Catch::Contains;
using nlohmann::json;

namespace {

constexpr double pi = std::numbers::pi;

Vec3 induction_at(const Polyhedron& magnet, const Vec3& place, const Vec3& magnetisation) {
  const LongMatrix3 h = magnet.at(place).hessian;
  const SymmetricTensor tensor = {double(h(0, 0)), double(h(0, 1)), double(h(0, 2)),
                                  double(h(1, 1)), double(h(1, 2)), double(h(2, 2))};
  return magnetic_induction(std::span(&tensor, 1), magnetisation)[0];
}

// Solid angle of a square of side 2 seen from its axis.
double square_angle(double distance) {
  return 4 * std::atan(2 / (distance * std::sqrt(4 * distance * distance + 8)));
}

} // namespace

TEST_CASE("a magnetised ball has two thirds of mu_0 M inside and a dipole's field outside", "[magnetisation]") {
  const Vec3 m(3e5, -1e5, 8e5);
  std::array<double, 2> inside{}, outside{};
  for (const int level : {1, 2}) {
    const RawMesh mesh = builtin_mesh(level == 1 ? "sphere:1@2" : "sphere:1@3");
    const Polyhedron ball(mesh.vertices, mesh.faces);
    const Vec3 whole = vacuum_permeability * m;
    inside[std::size_t(level - 1)] =
        (induction_at(ball, Vec3(0.2, -0.1, 0.3), m) - 2. / 3 * whole).norm() / whole.norm();
    const Vec3 far(1.5, -2, 2.5), n = far.normalized(), moment = volume(mesh.vertices, mesh.faces) * m;
    const Vec3 dipole = vacuum_permeability / (4 * pi) * (3 * n * n.dot(moment) - moment) / std::pow(far.norm(), 3);
    outside[std::size_t(level - 1)] = (induction_at(ball, far, m) - dipole).norm() / dipole.norm();
  }
  // By symmetry facets spoil the centre in degree 6 alone, and far away hardly anything.
  CHECK(inside[1] < 2e-5);
  CHECK(inside[1] < inside[0] / 2);
  CHECK(outside[1] < 3e-6);
  CHECK(outside[1] < outside[0] / 2);
}

TEST_CASE("on its axis a magnetised cube has the field of its two charged faces, and mu_0 M inside",
          "[magnetisation]") {
  const RawMesh mesh = test::box(Vec3::Constant(2), Vec3::Constant(-1));
  const Polyhedron cube(mesh.vertices, mesh.faces);
  const Vec3 m(0, 0, 1e6);
  const double whole = vacuum_permeability * m[2];
  for (const double z : {1.0001, 1.5, 3.0, 40.0}) {
    const Vec3 b = induction_at(cube, Vec3(0, 0, z), m);
    const double truth = whole / (4 * pi) * (square_angle(z - 1) - square_angle(z + 1));
    CHECK(std::abs(b[2] - truth) < 1e-14 * whole);
    CHECK(std::hypot(b[0], b[1]) < 1e-15 * whole);
  }
  for (const double z : {0.0, 0.3, -0.99}) {
    const double truth = whole * (1 - (square_angle(1 - z) + square_angle(1 + z)) / (4 * pi));
    CHECK(std::abs(induction_at(cube, Vec3(0, 0, z), m)[2] - truth) < 1e-14 * whole);
  }
  CHECK(induction_at(cube, Vec3::Zero(), m)[2] == Approx(2. / 3 * whole).epsilon(1e-14));
}

TEST_CASE("across a face the normal part of B goes on and its tangential part jumps by mu_0 M", "[magnetisation]") {
  const RawMesh mesh = test::box(Vec3(1, 2, 3));
  const Polyhedron magnet(mesh.vertices, mesh.faces);
  const Vec3 m(4e5, 5e5, -6e5), whole = vacuum_permeability * m;
  const Vec3 in = induction_at(magnet, Vec3(0.3, 0.7, 3 - 1e-9), m),
             out = induction_at(magnet, Vec3(0.3, 0.7, 3 + 1e-9), m), on = induction_at(magnet, Vec3(0.3, 0.7, 3), m);
  CHECK(std::abs(in[2] - out[2]) < 1e-7 * whole.norm());
  CHECK((in - out - Vec3(whole[0], whole[1], 0)).norm() < 1e-7 * whole.norm());
  CHECK((on - (in + out) / 2).norm() < 1e-7 * whole.norm());
}

TEST_CASE("the command gives B beside the potential, on lattices and in files too", "[magnetisation][potential][cli]") {
  const test::TemporaryFolder folder;
  const auto run = [](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "potential");
    return test::run_program(arguments);
  };
  const auto one = run({"builtin:box:2,2,2", "--magnetisation", "0,0,1e6", "--exact", "--at", "0,0,1.5", "--json"});
  REQUIRE(one.exit_code == 0);
  const json found = json::parse(one.out);
  const double truth = vacuum_permeability * 1e6 / (4 * pi) * (square_angle(0.5) - square_angle(2.5));
  CHECK(found["induction"][2].get<double>() == Approx(truth).epsilon(1e-12));
  CHECK(found["units"]["induction"] == "T");
  // A hole in it: a magnet of the opposite sense.
  const std::string hole = folder / "hole.off", csv = folder / "lattice.csv", nc = folder / "lattice.nc";
  std::ofstream(hole)
      << "OFF\n4 4 6\n-.5 -.5 -.5\n.5 -.5 -.5\n-.5 .5 -.5\n-.5 -.5 .5\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const auto with_hole = run({"builtin:box:2,2,2", "--magnetisation", "0,0,1e6", "--part", hole + "=-1", "--exact",
                              "--at", "-0.3,-0.3,-0.3", "--json"});
  REQUIRE(with_hole.exit_code == 0);
  const json left = json::parse(with_hole.out);
  CHECK(std::abs(left["density"].get<double>()) < 1e-12);
  for (const std::string& file : {csv, nc})
    REQUIRE(
        run({"builtin:box:2,2,2", "--magnetisation", "0,0,1e6", "--exact", "--grid", "3,5", "-o", file}).exit_code ==
        0);
  std::ifstream lines(csv);
  std::string line, names;
  std::size_t rows = 0;
  std::vector<double> last;
  while (std::getline(lines, line)) {
    if (line[0] == '#') continue;
    if (names.empty()) {
      names = line;
      continue;
    }
    ++rows;
    last.clear();
    for (std::size_t at = 0; at < line.size(); at = std::min(line.find(',', at), line.size()) + 1)
      last.push_back(std::strtod(line.c_str() + at, nullptr));
    if (rows == 2) CHECK(std::vector<double>(last.begin(), last.begin() + 3) == std::vector<double>{-1.5, -3, -3});
  }
  CHECK(rows == 125);
  CHECK_THAT(names, Contains(",b_x,b_y,b_z"));
  REQUIRE(last.size() >= 16);
  CHECK(std::vector<double>(last.begin(), last.begin() + 3) == std::vector<double>{3, 3, 3});
  for (const auto& [arguments, word] :
       {std::pair(std::vector<std::string>{"--magnetisation", "1,2"}, "X,Y,Z"),
        std::pair(std::vector<std::string>{"--magnetisation", "0,0,1", "--density", "2"}, "leave --density out"),
        std::pair(std::vector<std::string>{"--magnetisation", "0,0,1", "--derivatives", "1"}, "second derivatives"),
        std::pair(std::vector<std::string>{"--magnetisation", "0,0,1", "--charge"}, "two kinds")}) {
    std::vector<std::string> all = {"builtin:box:2,2,2", "--exact", "--at", "3,0,0"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const auto refused = run(all);
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Contains(word));
  }
  const auto crowded = run({"builtin:box:2,2,2", "--exact", "--grid", "3,1"});
  CHECK(crowded.exit_code == 2);
  CHECK_THAT(crowded.err, Contains("EXTENT,N"));
}
