#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

using namespace cowgpu::test;
using Catch::Contains;
using nlohmann::json;

namespace {

json answer(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "potential");
  arguments.push_back("--json");
  const ProgramRun run = run_program(arguments);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  return json::parse(run.out);
}

void refused(std::vector<std::string> arguments, int code, const char* word) {
  arguments.insert(arguments.begin(), "potential");
  const ProgramRun run = run_program(arguments);
  INFO(run.err);
  CHECK(run.exit_code == code);
  CHECK(run.out.empty());
  CHECK_THAT(run.err, Contains(word));
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

constexpr double g = 6.6743e-11, k = 8.9875517923e9;

} // namespace

TEST_CASE("a box of water in SI far away: -G M/r, its acceleration and its gradient", "[potential][cli]") {
  const json found = answer({"builtin:box:1,1,1", "--length", "2m", "--density", "1g/cm3", "--origin", "com", "--at",
                             "0,0,200", "--device", "cpu"});
  const double mass = 8000, r = 200; // a cube has no quadrupole: its degree 4 is 1e-9 of that here
  CHECK(found["potential"].get<double>() == Approx(-g * mass / r).epsilon(1e-8));
  CHECK(found["acceleration"][2].get<double>() == Approx(-g * mass / (r * r)).epsilon(1e-8));
  CHECK(found["gradient"][2][2].get<double>() == Approx(2 * g * mass / (r * r * r)).epsilon(1e-7));
  CHECK(found["gradient"][0][0].get<double>() == Approx(-g * mass / (r * r * r)).epsilon(1e-7));
  CHECK(found["units"]["potential"] == "J/kg");
  CHECK(found["units"]["gradient"] == "1/s^2");
  CHECK(found["constant"] == g);
}

TEST_CASE("a charged box pushes its like away: volts and volts a metre", "[potential][cli]") {
  const json found = answer(
      {"builtin:box:1,1,1", "--length", "2m", "--density", "2uC/m3", "--charge", "--at", "0,0,200", "--device", "cpu"});
  const double charge = 16e-6, r = 200;
  CHECK(found["potential"].get<double>() == Approx(k * charge / r).epsilon(1e-8));
  CHECK(found["field"][2].get<double>() == Approx(k * charge / (r * r)).epsilon(1e-8));
  CHECK(found["gradient"][2][2].get<double>() == Approx(-2 * k * charge / (r * r * r)).epsilon(1e-7));
  CHECK(found["units"]["potential"] == "V");
  CHECK(found["law"] == "charge");
  // Minus two about plus two: no charge, a quadrupole, integral of density (2 x^2 - y^2 - z^2) = -1.
  const json pair = answer({"builtin:box:2,1,1", "--density", "-1", "--charge", "--part", "builtin:box:1,1,1=2",
                            "--origin", "mesh", "--at", "-100,0,0", "--device", "cpu"});
  CHECK(pair["potential"].get<double>() == Approx(-0.5e-6).epsilon(1e-3));
  CHECK(pair["field"][0].get<double>() == Approx(1.5e-8).epsilon(1e-3));
}

TEST_CASE("without units G is 1, and the output says so", "[potential][cli]") {
  const ProgramRun run = run_program({"potential", "builtin:box:1,2,3", "--at", "7,8,9", "--device", "cpu"});
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("G = 1"));
  CHECK_THAT(run.out, Contains("G * density * length^2"));
}

TEST_CASE("series and polyhedron give one field outside, and inside the polyhedron alone", "[potential][cli]") {
  const std::vector<std::string> body = {"builtin:cow@1", "--sphere", "2R", "--resolution", "5", "--device", "cpu"};
  std::vector<std::string> exact = body, series = body;
  exact.push_back("--exact");
  series.insert(series.end(), {"--order", "60"});
  const json a = answer(series), b = answer(exact);
  REQUIRE(a["points"]["rows"].size() == b["points"]["rows"].size());
  REQUIRE(a["points"]["rows"].size() > 40);
  for (std::size_t i = 0; i < a["points"]["rows"].size(); ++i)
    for (std::size_t c = 0; c < 13; ++c) {
      const double x = a["points"]["rows"][i][c], y = b["points"]["rows"][i][c];
      CHECK(std::abs(x - y) <= 1e-12);
    }
  CHECK(a["exact_count"] == 0);
  CHECK(b["exact_count"] == b["point_count"]);

  refused({"builtin:box:1,1,1", "--at", "0,0,0.25", "--device", "cpu"}, 3,
          "0.25 from the body's origin and 0.616025 "
          "inside");
  const json middle = answer({"builtin:box:1,1,1", "--at", "0,0,0", "--inside", "exact", "--device", "cpu"});
  CHECK(middle["potential"].get<double>() ==
        Approx(std::numbers::pi / 2 - 3 * std::log(2 + std::sqrt(3.0))).epsilon(1e-14));
  CHECK(middle["density"] == Approx(1));
  CHECK(middle["exact_count"] == 1);
  const json plane = answer({"builtin:box:1,1,1", "--plane", "z,0.1,2,5", "--inside", "exact", "--device", "cpu"});
  CHECK(plane["point_count"] == 25);
  CHECK(plane["exact_count"] == 1);
  refused({"builtin:box:1,1,1", "--at", "0.5,0.5,0.3", "--exact", "--device", "cpu"}, 3, "point-singular");
  answer({"builtin:box:1,1,1", "--at", "0.5,0.5,0.3", "--exact", "--derivatives", "1", "--device", "cpu"});
}

TEST_CASE("on the sphere that holds the body --inside exact takes the polyhedron, and near it the series says how near",
          "[potential][cli]") {
  const std::string corner = "0.5,1,1.5";
  refused({"builtin:box:1,2,3", "--at", corner, "--inside", "exact"}, 3, "point-singular");
  const json exact = answer({"builtin:box:1,2,3", "--at", corner, "--exact", "--derivatives", "1"}),
             inside = answer({"builtin:box:1,2,3", "--at", corner, "--inside", "exact", "--derivatives", "1"});
  CHECK(inside["exact_count"] == 1);
  CHECK(inside["acceleration"] == exact["acceleration"]);
  const auto notes = [&](const char* place) {
    return answer({"builtin:box:1,2,3", "--at", place, "--device", "cpu"})["notes"].dump();
  };
  CHECK_THAT(notes("0,0,1.9"), Contains("its terms have fallen"));
  CHECK_THAT(notes("0,0,20"), !Contains("its terms have fallen"));
}

TEST_CASE("coefficient files of masses and potentials give the mesh's field, and those of surfaces are refused",
          "[potential][cli]") {
  const TemporaryFolder folder;
  const std::string name = folder / "cow.json", geodesy = folder / "cow.gfc", surface = folder / "surface.csv";
  const std::vector<std::string> units = {"--length-unit", "2m", "--density", "1g/cm3"};
  std::vector<std::string> expand = {"expand",   "builtin:cow@1", "--lmax",   "9",
                                     "--device", "cpu",           "--origin", "0.1,0,0"};
  std::vector<std::string> with_units = expand, without = expand;
  with_units.insert(with_units.end(), units.begin(), units.end());
  with_units.insert(with_units.end(), {"-o", geodesy});
  without.insert(without.end(), {"-o", name});
  // The origin is in the placed mesh's coordinates.
  with_units[7] = "0.2,0,0";
  REQUIRE(run_program(with_units).exit_code == 0);
  REQUIRE(run_program(without).exit_code == 0);
  std::vector<std::string> mesh = {"builtin:cow@1", "--origin", "0.2,0,0",  "--order", "9",
                                   "--at",          "3,-2,4",   "--device", "cpu"};
  mesh.insert(mesh.end(), units.begin(), units.end());
  std::vector<std::string> file = {name, "--at", "3,-2,4", "--device", "cpu"};
  file.insert(file.end(), units.begin(), units.end());
  const json truth = answer(mesh), by_json = answer(file),
             by_gfc = answer({geodesy, "--at", "3,-2,4", "--device", "cpu"});
  for (const json& found : {by_json, by_gfc}) {
    CHECK(found["units"]["potential"] == "J/kg");
    CHECK(found["potential"].get<double>() == Approx(truth["potential"].get<double>()).epsilon(1e-13));
    CHECK(found["acceleration"][1].get<double>() == Approx(truth["acceleration"][1].get<double>()).epsilon(1e-12));
  }
  // A density takes the place of the file's own, and without one that stands.
  const auto value = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--at", "3,-2,4", "--device", "cpu"});
    return answer(arguments)["potential"].get<double>();
  };
  const std::string dense = folder / "dense.json";
  std::vector<std::string> denser = expand;
  denser.insert(denser.end(), {"--density", "2.5", "-o", dense});
  REQUIRE(run_program(denser).exit_code == 0);
  const double of_one = value({name});
  CHECK(value({dense}) == Approx(2.5 * of_one).epsilon(1e-14));
  CHECK(value({dense, "--density", "3"}) == Approx(3 * of_one).epsilon(1e-14));
  CHECK(value({name, "--density", "3"}) == Approx(3 * of_one).epsilon(1e-14));
  CHECK(value({dense, "--length-unit", "2m"}) ==
        Approx(2.5 * value({name, "--length-unit", "2m", "--density", "1kg/m3"})).epsilon(1e-14));
  CHECK(value({dense, "--length-unit", "2m", "--density", "1g/cm3"}) ==
        Approx(truth["potential"].get<double>()).epsilon(1e-13));
  refused({geodesy, "--at", "3,-2,4", "--density", "2"}, 2, "kilograms already");
  refused({geodesy, "--at", "3,-2,4", "--length-unit", "1m"}, 2, "already");
  refused({geodesy, "--at", "3,-2,4", "--charge"}, 2, "kilograms");
  refused({name, "--at", "3,-2,4", "--exact"}, 3, "takes the exact polyhedron");
  refused({name, "--errors"}, 3, "takes the exact polyhedron");
  refused({name, "--at", "3,-2,4", "--order", "10"}, 2, "end at degree 9");
  refused({name, "--at", "0,0,0"}, 3, "point-inside");
  REQUIRE(run_program({"expand", "builtin:cow@1", "--of", "harmonic", "--lmax", "3", "--device", "cpu", "-o", surface})
              .exit_code == 0);
  refused({surface, "--at", "3,-2,4"}, 3, "coefficients of a surface");
}

TEST_CASE("files of potentials have every point, as text and as a grid", "[potential][cli]") {
  const TemporaryFolder folder;
  const std::string points = folder / "points.txt", csv = folder / "found.csv", netcdf = folder / "sphere.nc";
  std::ofstream(points) << "x y z\n5 0 0\n0 6 0\n# none\n0 0 -7\n";
  const json found = answer({"builtin:cow@1", "--at", points, "-o", csv, "--device", "cpu", "-q"});
  CHECK(found["point_count"] == 3);
  std::istringstream lines(text_of(csv));
  std::vector<std::string> rows;
  for (std::string line; std::getline(lines, line);)
    if (line[0] != '#') rows.push_back(line);
  REQUIRE(rows.size() == 4);
  CHECK(rows[0] == "x,y,z,potential,ax,ay,az,axx,axy,axz,ayy,ayz,azz");
  CHECK(std::stod(rows[1].substr(6)) == found["points"]["rows"][0][3].get<double>());
  REQUIRE(
      run_program({"potential", "builtin:cow@1", "--sphere", "2", "--resolution", "9", "-o", netcdf, "--device", "cpu"})
          .exit_code == 0);
  CHECK(text_of(netcdf).size() > 9 * 17 * 13 * 8);
}

TEST_CASE("how good the multipoles are, as tables and as a picture", "[potential][cli]") {
  const TemporaryFolder folder;
  const std::string picture = folder / "errors.svg";
  const json found = answer({"builtin:box:1,2,3", "--errors", "--orders", "0..2,8", "--distances", "1,2,4", "--plot",
                             picture, "--device", "cpu"});
  CHECK(found["errors"]["rows"].size() == 12);
  CHECK(found["errors"]["columns"][2] == "potential_max");
  CHECK(found["good_from"]["rows"].size() == 4);
  const auto& order_8 = found["good_from"]["rows"][3];
  CHECK((order_8[1] < order_8[2] && order_8[2] < order_8[3]));
  CHECK_THAT(text_of(picture), Contains("<svg"));
}

TEST_CASE("the paper's factor before the moments stands beside the right one", "[potential][cli]") {
  const json found = answer({"builtin:cow@1", "--recipe", "paper", "--at", "3,0,0", "--device", "cpu"});
  REQUIRE(found["paper"].size() == 2);
  CHECK(found["paper"][0]["ours"].get<double>() == Approx(4 * std::numbers::pi));
  CHECK(found["paper"][0]["paper"].get<double>() == Approx(std::sqrt(4 * std::numbers::pi)));
  CHECK(found["units"]["potential"] == "J/kg");
}

TEST_CASE("what is no place, no order and no unit is refused by name", "[potential][cli]") {
  for (const char* at : {"1,2", "1,2,3,4", "5", "1 2 3", "1;2;3"})
    refused({"builtin:box:1,1,1", "--at", at}, 2, "it takes X,Y,Z, three finite numbers");
  refused({"builtin:box:1,1,1", "--at", "no-such-points.txt"}, 5, "no-such-points.txt");
  const TemporaryFolder folder;
  const std::string broken = folder / "broken.txt", nothing = folder / "nothing.txt",
                    infinite = folder / "infinite.txt";
  std::ofstream(broken) << "1,2,3\n4,5\n";
  std::ofstream(nothing) << "# nobody\n";
  std::ofstream(infinite) << "1,2,nan\n";
  const std::string body = "builtin:box";
  refused({body}, 2, "--at, --sphere, --plane or --grid");
  refused({body, "--at", "9,9,9", "--sphere", "9"}, 2, "give one of them");
  refused({body, "--at", "9,9,nan"}, 2, "three finite numbers");
  refused({body, "--at", broken}, 3, "broken.txt:2");
  refused({body, "--at", nothing}, 3, "no point");
  refused({body, "--at", infinite}, 3, "finite number");
  refused({body, "--at", folder / "missing.txt"}, 5, "missing.txt");
  refused({body, "--sphere", "0"}, 2, "above 0");
  refused({body, "--sphere", "-1R"}, 2, "above 0");
  refused({body, "--sphere", "2m"}, 2, "--length-unit");
  refused({body, "--sphere", "wide"}, 2, "no number");
  refused({body, "--sphere", "0.5R"}, 3, "point-inside");
  refused({body, "--plane", "z,9,0,5"}, 2, "extent 0");
  refused({body, "--plane", "w,9,1,5"}, 2, "AXIS,OFFSET,EXTENT,N");
  refused({body, "--plane", "z,9,1"}, 2, "AXIS,OFFSET,EXTENT,N");
  refused({body, "--plane", "z,9,1,1000000"}, 2, "AXIS,OFFSET,EXTENT,N");
  refused({body, "--sphere", "2", "--resolution", "99999999"}, 2, "--resolution");
  refused({body, "--at", "9,9,9", "--order", "1537"}, 2, "--order");
  refused({body, "--at", "9,9,9", "--density", "1kg/m3", "--charge", "--length", "1m"}, 2, "C/m3");
  refused({body, "--errors", "--distances", "0.5"}, 2, "--distances");
  refused({body, "--errors", "--orders", "4..2"}, 2, "backwards");
  refused({body, "--errors", "--at", "9,9,9"}, 2, "places of its own");
  refused({body, "--at", "9,9,9", "--plot", "a.png"}, 2, "--errors");
  refused({body, "--errors", "--plot", "a.gif"}, 2, ".png");
  refused({body, "--at", "9,9,9", "-o", "-"}, 2, "name a file");
  refused({body, "--at", broken, "-o", broken}, 2, "broken.txt");
}
