#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

using namespace cowgpu::test;
using Catch::Contains;
using nlohmann::json;

namespace {

json answer(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "equilibria");
  arguments.insert(arguments.end(), {"--json", "--device", "cpu"});
  const ProgramRun run = run_program(arguments);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  return json::parse(run.out);
}

void refused(std::vector<std::string> arguments, int code, const char* word) {
  arguments.insert(arguments.begin(), "equilibria");
  const ProgramRun run = run_program(arguments);
  INFO(run.err);
  CHECK(run.exit_code == code);
  CHECK(run.out.empty());
  CHECK_THAT(run.err, Contains(word));
}

json column(const json& table, const char* name) {
  const auto& columns = table["columns"];
  const std::size_t k = std::size_t(std::find(columns.begin(), columns.end(), name) - columns.begin());
  REQUIRE(k < columns.size());
  json values;
  for (const json& row : table["rows"]) values.push_back(row[k]);
  return values;
}

} // namespace

TEST_CASE("equilibria of a box are the same in SI, but for their units", "[equilibria][cli]") {
  const json plain = answer({"builtin:box:3,2,1", "--omega", "0.8"});
  // One unit is a kilometre, the density 2 g/cm3; 1/sqrt(G density) seconds are a unit of time.
  const double second = 1 / std::sqrt(6.6743e-11 * 2000);
  const std::string period = std::to_string(2 * std::numbers::pi / 0.8 * second) + "s";
  const json si = answer({"builtin:box:3,2,1", "--length-unit", "km", "--density", "2g/cm3", "--period", period});
  CHECK(plain["complete"] == true);
  CHECK(plain["index_sum"] == -1);
  CHECK(plain["equilibrium_count"] == 5);
  CHECK(plain["outside_count"] == 4);
  CHECK(plain["spin_axis"] == json({0, 0, 1}));
  CHECK(si["equilibrium_count"] == 5);
  CHECK(si["units"]["spin_rate"] == "rad/s");
  CHECK(si["mass"].get<double>() == Approx(1.2e13).epsilon(1e-13));
  CHECK(si["synchronous_radius"].get<double>() == Approx(1e3 * std::cbrt(6 / 0.64)).epsilon(1e-6));
  const json x = column(plain["equilibria"], "distance"), metres = column(si["equilibria"], "distance");
  const json e_fold = column(plain["equilibria"], "e_fold"), seconds = column(si["equilibria"], "e_fold");
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(metres[i].get<double>() == Approx(1e3 * x[i].get<double>()).margin(1e-6).epsilon(1e-6));
    CHECK(e_fold[i].is_null() == seconds[i].is_null());
    if (!e_fold[i].is_null()) CHECK(seconds[i].get<double>() == Approx(second * e_fold[i].get<double>()).epsilon(1e-6));
  }
}

TEST_CASE("a zero-velocity surface is written with its constant", "[equilibria][cli]") {
  const TemporaryFolder folder;
  const std::string ply = folder / "zero.ply";
  const json found =
      answer({"builtin:box:3,2,1", "--omega", "0.8", "--surface", "E2", "--surface-cells", "12", "-o", ply});
  CHECK(found["surface_jacobi"] == column(found["equilibria"], "jacobi")[1]);
  CHECK(found["surface_triangles"].get<double>() > 100);
  std::ifstream file(ply);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  CHECK_THAT(text, Contains("element face " + std::to_string(int(found["surface_triangles"].get<double>()))));
  refused({"builtin:box:3,2,1", "--omega", "0.8", "--surface", "E9", "-o", ply, "--device", "cpu"}, 2, "5 were found");
  refused({"builtin:box:3,2,1", "--omega", "0.8", "--surface", "1", "-o", ply, "--device", "cpu"}, 2,
          "no zero-velocity");
}

TEST_CASE("equilibria without a spin, an axis, units or a mass are refused in words", "[equilibria][cli]") {
  refused({"builtin:box:3,2,1"}, 2, "--period or --omega");
  refused({"builtin:box:3,2,1", "--omega", "1", "--period", "1"}, 2, "leave one out");
  refused({"builtin:box:3,2,1", "--omega", "0"}, 2, "above 0");
  refused({"builtin:box:3,2,1", "--period", "-5h"}, 2, "above 0");
  refused({"builtin:box:3,2,1", "--omega", "1rad/s"}, 2, "--length-unit");
  refused({"builtin:box:3,2,1", "--omega", "1", "--length-unit", "km"}, 2, "needs a unit");
  refused({"builtin:box:1,1,1", "--omega", "1"}, 2, "--spin");
  refused({"builtin:box:3,2,1", "--omega", "1", "--density", "2", "--mass", "3"}, 2, "leave one out");
  refused({"builtin:box:3,2,1", "--omega", "1", "--mass", "-3"}, 2, "above 0");
  refused({"builtin:box:3,2,1", "--omega", "1", "--surface", "E1"}, 2, "give both");
  refused({"builtin:box:3,2,1", "--omega", "1", "--surface", "q", "-o", "zero.ply"}, 2, "Jacobi constant");
}
