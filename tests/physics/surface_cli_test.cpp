#include "tests/support/mesh_files.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace cowgpu::test;
using Catch::Contains;
using nlohmann::json;

namespace {

std::vector<std::string> surface_with(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "surface");
  arguments.insert(arguments.end(), {"--device", "cpu"});
  return arguments;
}

json answer(const std::vector<std::string>& arguments) {
  std::vector<std::string> all = surface_with(arguments);
  all.push_back("--json");
  const ProgramRun run = run_program(all);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  return json::parse(run.out);
}

void refused(const std::vector<std::string>& arguments, int code, const char* words) {
  const ProgramRun run = run_program(surface_with(arguments));
  INFO(run.err);
  CHECK(run.exit_code == code);
  CHECK(run.out.empty());
  CHECK_THAT(run.err, Contains(words));
}

std::vector<std::string> lines_of(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

std::vector<double> numbers_of_line(const std::string& line) {
  std::vector<double> numbers;
  std::istringstream words(line);
  for (std::string word; std::getline(words, word, ',');) numbers.push_back(std::stod(word));
  return numbers;
}

// Of a table with a row for each quantity.
double range(const json& found, const std::string& quantity, const std::string& which) {
  const auto& columns = found["ranges"]["columns"];
  for (const auto& row : found["ranges"]["rows"])
    if (row[0] == quantity)
      for (std::size_t c = 0; c < columns.size(); ++c)
        if (columns[c] == which) return row[c].get<double>();
  FAIL("there is no " << which << " " << quantity);
  return 0;
}

} // namespace

TEST_CASE("surface writes a row a face in the order of its file, under the names that readers expect",
          "[surface-gravity][cli]") {
  const TemporaryFolder folder;
  const std::string csv = folder / "box.csv";
  const json found =
      answer({"builtin:box:1,2,3", "--length-unit", "km", "--density", "2g/cm3", "--period", "5h", "-o", csv});
  const std::vector<std::string> lines = lines_of(csv);
  REQUIRE(lines.size() == 13);
  CHECK_THAT(lines[0], Catch::StartsWith("id,x,y,z,potential,g_x,g_y,g_z,g,"));
  CHECK(lines[0] == "id,x,y,z,potential,g_x,g_y,g_z,g,geopotential,slope,elevation,escape_speed,tilt");
  double most = 0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<double> row = numbers_of_line(lines[i]);
    REQUIRE(row.size() == 14);
    CHECK(row[0] == double(i - 1));
    CHECK(std::hypot(row[5], row[6], row[7]) == Approx(row[8]).epsilon(1e-14));
    CHECK(row[12] == Approx(std::sqrt(-2 * row[4])).epsilon(1e-14));
    most = std::max(most, row[8]);
  }
  CHECK(range(found, "g", "greatest") == most);
  const json about = json::parse(std::ifstream(csv + ".json"));
  CHECK_THAT(about.dump(), Contains("m/s^2") && Contains("J/kg") && Contains("below 0"));
  CHECK(found["mass"].get<double>() == Approx(12e12).epsilon(1e-14));
  CHECK(found["spin_period"].get<double>() == Approx(18000).epsilon(1e-14));
  CHECK(std::abs(found["spin_axis"][0].get<double>()) == Approx(1)); // the shortest side
  CHECK(found["units"]["gravity_error"] == "m/s^2");
  double fractions = 0;
  for (const auto& row : found["slopes"]["rows"]) fractions += row[2].get<double>();
  CHECK(fractions == Approx(1).epsilon(1e-12));
}

TEST_CASE("potential and surface print one field with one sign", "[surface-gravity][cli]") {
  const TemporaryFolder folder;
  const std::string points = folder / "points.csv", csv = folder / "out.csv";
  std::ofstream(points) << "x,y,z\n1100,200,-300\n0,0,0\n-5000,1,2\n";
  const std::vector<std::string> body = {"builtin:box:1,2,3", "--length-unit", "km", "--density", "2g/cm3"};
  std::vector<std::string> one = body, other = body;
  one.insert(one.end(), {"--at", points, "-o", csv, "--tolerance", "0"});
  answer(one);
  other.insert(other.begin(), "potential");
  other.insert(other.end(), {"--at", points, "--exact", "--derivatives", "1", "--json"});
  const ProgramRun run = run_program(other);
  REQUIRE(run.exit_code == 0);
  const json exact = json::parse(run.out)["points"]["rows"];
  const std::vector<std::string> lines = lines_of(csv);
  REQUIRE(lines.size() == 4);
  CHECK(lines[0] == "id,x,y,z,potential,g_x,g_y,g_z,g,geopotential,escape_speed");
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double> row = numbers_of_line(lines[i + 1]);
    CHECK(row[4] == Approx(exact[i][3].get<double>()).epsilon(1e-13));
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(row[5 + c] - exact[i][4 + c].get<double>()) <= 1e-13 * 1e-3);
  }
}

TEST_CASE("bounds stand beside the values with --guarantee, and every format is written", "[surface-gravity][cli]") {
  const TemporaryFolder folder;
  std::vector<std::string> arguments = {"builtin:cow@1", "--at", "vertices", "--tolerance", "1e-6", "--guarantee"};
  for (const char* suffix : {"csv", "vtp", "ply", "glb", "nc"})
    arguments.insert(arguments.end(), {"-o", folder / (std::string("cow.") + suffix)});
  const json found = answer(arguments);
  for (const char* suffix : {"csv", "vtp", "ply", "glb", "nc"})
    CHECK(std::filesystem::file_size(folder / (std::string("cow.") + suffix)) > 10000);
  CHECK_THAT(lines_of(folder / "cow.csv")[0], Contains(",g_bound"));
  CHECK(range(found, "g_bound", "greatest") <= 1e-6 * found["gravity_scale"].get<double>() * (1 + 1e-9));
  CHECK(found["guarantee"] == true);
  CHECK(found["place_count"] == 1642);
}

TEST_CASE("surface says before what it takes", "[surface-gravity][cli]") {
  const ProgramRun run = run_program(surface_with({"builtin:cow@2", "--dry-run", "--at", "vertices"}));
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("13120 faces at 6562 places, to 1e-09 of G M/R^2") && Contains("memory: at most"));
}

TEST_CASE("surface refuses wrong units, bodies without a spin axis, open meshes and empty files of points by name",
          "[surface-gravity][cli]") {
  const TemporaryFolder folder;
  const std::string empty = folder / "empty.csv", far = folder / "far.csv", open = folder / "open.off",
                    nan = folder / "nan.csv";
  std::ofstream(empty) << "x,y,z\n";
  std::ofstream(far) << "1e308,1e308,1e308\n";
  std::ofstream(nan) << "inf,0,0\n";
  std::ofstream(open) << "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n";
  refused({"builtin:box", "--period", "5h"}, 2, "needs the mesh's unit of length");
  refused({"builtin:box:1,2,3", "--length", "1km", "--period", "5"}, 2, "it needs a unit");
  refused({"builtin:box:1,2,3", "--length", "1km", "--period", "5km"}, 2, "no unit is called km");
  refused({"builtin:box:1,2,3", "--period", "5", "--omega", "1"}, 2, "leave one out");
  refused({"builtin:box:1,2,3", "--period", "-5"}, 2, "must be above 0");
  refused({"builtin:sphere", "--length", "1km", "--period", "5h"}, 2, "three equal moments of inertia");
  refused({"builtin:box:1,2,3", "--spin", "z"}, 2, "not how fast");
  refused({"builtin:box", "--mass", "3kg"}, 2, "needs the mesh's unit of length");
  refused({"builtin:box", "--mass", "3kg", "--length", "1m", "--density", "1g/cm3"}, 2, "leave one out");
  refused({"builtin:box", "--tolerance", "1e-15"}, 2, "from 1e-12 to 0.01");
  refused({"builtin:box", "--tolerance", "0", "--guarantee"}, 2, "leaves nothing out");
  refused({open}, 3, "mesh-open");
  refused({"builtin:box", "--at", empty}, 3, "there is no point");
  refused({"builtin:box", "--at", nan}, 3, "finite number expected");
  refused({"builtin:box", "--at", far}, 3, "farther than 1e150 radii");
  refused({"builtin:box", "--at", folder / "none.csv"}, 5, "cannot-read");
  refused({"builtin:box", "--at", far, "--height", "1"}, 2, "stand where they are");
  refused({"builtin:box", "--height", "-0.1"}, 2, "inside the body");
  refused({"builtin:box", "--height", "1e300"}, 2, "nothing is left of its surface");
  refused({"builtin:box:1,2,3", "--period", "1e-300"}, 2, "from 1e-50 to 1e50");
  const std::string points = folder / "points.csv.json", beside = folder / "points.csv";
  std::ofstream(points) << "1,2,3\n";
  refused({"builtin:box", "--at", points, "-o", beside}, 2, "points.csv.json");
  refused({"builtin:box", "-o", beside, "-o", beside}, 2, "more than once");
  refused({"builtin:box", "-o", "out.txt"}, 2, ".vtp");
  refused({"builtin:box", "-o", folder / "no/such/out.vtp"}, 5, "cannot-write");
}
