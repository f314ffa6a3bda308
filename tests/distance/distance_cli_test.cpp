#include "host/io/csv_table.hpp"
#include "host/io/netcdf.hpp"
#include "host/types.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

ProgramRun distance(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "distance");
  arguments.insert(arguments.end(), {"--device", "cpu"});
  return run_program(arguments);
}

void write_file(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}
std::string read_text_file(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// The rows, split at commas; comments and names left out.
std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#') || line.starts_with('x')) continue;
    rows.emplace_back();
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ',');) rows.back().push_back(word);
  }
  return rows;
}

// From the box of sides 1, 2, 3 about 0, negative inside.
double box_distance(const Vec3& p) {
  const Vec3 outside = p.cwiseAbs() - Vec3(0.5, 1, 1.5);
  return outside.maxCoeff() > 0 ? outside.cwiseMax(0.0).norm() : outside.maxCoeff();
}

std::vector<double> netcdf_values(int file, const char* name, std::size_t count) {
  int id = 0;
  REQUIRE(nc_inq_varid(file, name, &id) == NC_NOERR);
  std::vector<double> values(count);
  REQUIRE(nc_get_var_double(file, id, values.data()) == NC_NOERR);
  return values;
}

} // namespace

TEST_CASE("distance writes what is asked about each point, in the order of the input", "[distance-cli]") {
  const TemporaryFolder folder;
  write_file(folder / "points.csv", "# made by hand\n\ny,name,x,z\n0,a,0.25,0\n3,b,2,4\n1,c,0.5,1.5\n0,d,5,0\n");
  const ProgramRun run = distance({"builtin:box:1,2,3", folder / "points.csv", "-o", folder / "out.csv"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("computed: signed distances of 4 points") && Contains("CPU path on") &&
                          Contains("points: 1 inside, 2 outside, 1 on the surface"));
  const std::string text = read_text_file(folder / "out.csv");
  CHECK_THAT(text, Contains("# mesh builtin:box:1,2,3") && Contains("# signed yes\n"));
  const auto rows = rows_of(text);
  REQUIRE(rows.size() == 4);
  const std::vector<std::vector<std::string>> begin = {{"0.25", "0", "0", "-0.25", "0.5"},
                                                       {"2", "3", "4", fmt::format("{}", Vec3(1.5, 2, 2.5).norm())},
                                                       {"0.5", "1", "1.5", "0"},
                                                       {"5", "0", "0", "4.5", "0.5"}};
  const std::vector<std::string> kinds = {"", "vertex", "vertex", ""}, winding = {"1", "0", "", "0"};
  for (std::size_t i = 0; i < 4; ++i) {
    REQUIRE(rows[i].size() == 15);
    CHECK(std::equal(begin[i].begin(), begin[i].end(), rows[i].begin()));
    if (i != 0 && i != 3) CHECK(rows[i][11] == kinds[i]); // the others lie on a diagonal or not, as rounding has it
    if (i != 2) CHECK(rows[i][14] == winding[i]);
  }
}

TEST_CASE("distance reads points between commas or blanks, with or without names, from a file or standard input",
          "[distance-cli]") {
  const TemporaryFolder folder;
  const std::vector<std::string> texts = {"1,2,3\n-4,5e-1,+6\n", "1 2 3\r\n-4\t0.5   6",
                                          "\xef\xbb\xbf x , y , z\n1,2,3\n-4,.5,6\n",
                                          "1,2,3,9,9 # more\n\n# nothing\n-4,0.5,6,milk\n"};
  std::string first;
  for (const std::string& text : texts) {
    write_file(folder / "in.txt", text);
    const ProgramRun run = distance({"builtin:box:1,2,3", folder / "in.txt", "-o", "-"});
    INFO(text << run.err);
    CHECK(run.exit_code == 0);
    if (first.empty()) first = run.out;
    CHECK(run.out == first);
  }
  CHECK(rows_of(first).size() == 2);
  const ProgramRun nothing = distance({"builtin:box:1,2,3", "-"}); // standard input is empty
  CHECK(nothing.exit_code == 3);
  CHECK_THAT(nothing.err, Contains("standard input"));
}

TEST_CASE("a lattice of distances is a netCDF file with coordinates", "[distance-cli]") {
  const TemporaryFolder folder;
  const ProgramRun run = distance({"builtin:box:1,2,3", "--grid", "12", "-o", folder / "out.nc"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("grid: 5 x 9 x 12 points 0.3 apart, the bounding box enlarged by 1.1"));
  int file = 0;
  REQUIRE(nc_open((folder / "out.nc").c_str(), NC_NOWRITE, &file) == NC_NOERR);
  const auto x = netcdf_values(file, "x", 5), y = netcdf_values(file, "y", 9), z = netcdf_values(file, "z", 12);
  CHECK((x.front() == Approx(-0.6) && x.back() == Approx(0.6) && z.front() == Approx(-1.65)));
  const std::size_t count = std::size_t(5) * 9 * 12;
  const auto d = netcdf_values(file, "distance", count), qx = netcdf_values(file, "closest_x", count),
             qy = netcdf_values(file, "closest_y", count), qz = netcdf_values(file, "closest_z", count),
             winding = netcdf_values(file, "winding", count), face = netcdf_values(file, "face", count),
             kind = netcdf_values(file, "feature", count);
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p(x[i % 5], y[i / 5 % 9], z[i / 45]), q(qx[i], qy[i], qz[i]);
    worst = std::max({worst, std::abs(d[i] - box_distance(p)), std::abs(std::abs(d[i]) - (p - q).norm())});
    CHECK(winding[i] == (box_distance(p) < 0));
    CHECK((face[i] >= 0 && face[i] < 12 && kind[i] >= 0 && kind[i] <= 2));
  }
  INFO(worst);
  CHECK(worst < 2e-15);
  int id = 0, dimensions[3] = {};
  char name[NC_MAX_NAME + 1];
  REQUIRE(nc_inq_varid(file, "distance", &id) == NC_NOERR);
  REQUIRE(nc_inq_vardimid(file, id, dimensions) == NC_NOERR);
  for (int c = 0; c < 3; ++c) {
    REQUIRE(nc_inq_dimname(file, dimensions[c], name) == NC_NOERR);
    CHECK(std::string(name) == std::string(1, "zyx"[c]));
  }
  nc_close(file);
  // The same as CSV, and of points as netCDF.
  REQUIRE(distance({"builtin:box:1,2,3", "--grid", "12", "-o", folder / "out.csv"}).exit_code == 0);
  const auto rows = rows_of(read_text_file(folder / "out.csv"));
  REQUIRE(rows.size() == count);
  for (std::size_t i = 0; i < count; ++i) CHECK(std::stod(rows[i][3]) == d[i]);
  REQUIRE(distance({"builtin:box:1,2,3", folder / "out.csv", "-o", folder / "points.nc"}).exit_code == 0);
  const NetcdfFile points = read_netcdf(folder / "points.nc");
  REQUIRE((points.variable("distance") && points.variable("x")));
  CHECK(points.variable("distance")->values == d);
  CHECK(points.variable("x")->values[1] == x[1]);
}

TEST_CASE("distances without sign are for open surfaces as well", "[distance-cli]") {
  const TemporaryFolder folder;
  write_file(folder / "one.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  write_file(folder / "p.csv", "0.25,0.25,-2\n");
  const ProgramRun run = distance({folder / "one.off", folder / "p.csv", "--unsigned", "-o", "-"});
  INFO(run.err);
  CHECK(run.exit_code == 0);
  const auto rows = rows_of(run.out);
  REQUIRE((rows.size() == 1 && rows[0].size() == 14));
  CHECK((rows[0][3] == "2" && rows[0][11] == "face"));
  const ProgramRun refused = distance({folder / "one.off", folder / "p.csv"});
  CHECK(refused.exit_code == 3);
  CHECK_THAT(refused.err, StartsWith("cowgpu: error [mesh-open]"));
}

TEST_CASE("distance refuses what it cannot do with one line, a reason and an exit code", "[distance-cli]") {
  const TemporaryFolder folder;
  const auto code = [&](const std::vector<std::string>& arguments, int wanted, const std::string& words) {
    const ProgramRun run = distance(arguments);
    INFO(run.err);
    CHECK(run.exit_code == wanted);
    CHECK_THAT(run.err, Contains(words));
    CHECK(run.out.empty());
  };
  const std::string box = "builtin:box:1,2,3", p = folder / "p.csv", out = folder / "out.csv";
  write_file(p, "0,0,0\n");
  code({box}, 2, "either POINTS or --grid");
  code({box, p, "--grid", "5"}, 2, "either POINTS or --grid");
  code({box, "--grid", "1"}, 2, "bad-argument");
  code({box, p, "-o", folder / "out.txt"}, 2, "bad-argument");
  code({box, p, "-o", "-", "--json"}, 2, "both write to the standard output");
  code({box, folder / "none.csv"}, 5, "cannot-read");
  code({box, p, "-o", folder / "none/out.csv"}, 5, "cannot-write");
  code({folder / "none.off", p}, 5, "cannot-read");
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"0,0,0\n1,2\n", "p.csv:2: x, y and z expected, found 2 numbers"},
      {"0,0,0\n1,milk,3\n", "p.csv:2: a finite number expected; 'milk' is not a number"},
      {"0,0,0\n1,nan,3\n", "p.csv:2: a finite number expected; 'nan' is not finite"},
      {"0,0,0\n\n1,,3\n", "p.csv:3: a finite number expected; '' is empty"},
      {"0,0,0\n1,2,1e999\n", "p.csv:2: a finite number expected; '1e999' is beyond the range of doubles"},
      {"x,y,height\n1,2,3\n", "p.csv:1: a line of names without one that is z"},
      {"9,0 9,0 9,0\n", "p.csv:1: blanks and commas both part the numbers of '9,0 9,0 9,0'"},
      {"x,y,z\n", "there is no point"},
      {"", "there is no point"}};
  for (const auto& [text, words] : bad) {
    write_file(p, text);
    code({box, p, "-o", out}, 3, words);
    CHECK_FALSE(std::filesystem::exists(out));
  }
  write_file(p, "0,0,1e200\n");
  code({box, p}, 2, "beyond 1e+100");
}

TEST_CASE("a dry run of distance prints the plan and writes nothing", "[distance-cli]") {
  const TemporaryFolder folder;
  const ProgramRun run = distance({"builtin:box:1,2,3", "--grid", "100", "--dry-run", "-o", folder / "out.nc"});
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("plan: signed distances of 227800 points") && Contains("memory: at most"));
  CHECK(std::filesystem::is_empty(folder.path()));
}
