#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>

using namespace cowgpu::test;
using Catch::Contains;
using nlohmann::json;

namespace {

json answer(std::vector<std::string> arguments) {
  arguments.push_back("--json");
  const ProgramRun run = run_program(arguments);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  return json::parse(run.out);
}

void refused(const std::vector<std::string>& arguments, int code, const char* word) {
  const ProgramRun run = run_program(arguments);
  INFO(run.err);
  CHECK(run.exit_code == code);
  CHECK(run.out.empty());
  CHECK_THAT(run.err, Contains(word));
}

} // namespace

TEST_CASE("tensors in SI: a box of 1 x 2 x 3 feet of water", "[physics][cli]") {
  const json found = answer({"tensors", "builtin:box:1,2,3", "--length", "3ft", "--density", "1g/cm3"});
  const double unit = 1000 * std::pow(0.3048, 5);
  CHECK(found["inertia"][0][0].get<double>() == Approx(6.5 * unit).epsilon(1e-13));
  CHECK(found["principal_moments"][0].get<double>() == Approx(2.5 * unit).epsilon(1e-13));
  CHECK(found["units"]["inertia"] == "kg m^2");
}

TEST_CASE("tensors and radiation from coefficient files are those of the mesh", "[physics][cli]") {
  const TemporaryFolder folder;
  const std::string name = folder / "cow.json", turned = folder / "turned.csv", back = folder / "back.nc";
  REQUIRE(run_program({"expand", "builtin:cow@1", "--lmax", "3", "--device", "cpu", "-o", name}).exit_code == 0);
  REQUIRE(run_program({"convert", name, turned, "--kind", "potential", "--rotate", "10,20,30"}).exit_code == 0);
  REQUIRE(run_program({"convert", turned, back, "--rotate", "-30,-20,-10", "--form", "real"}).exit_code == 0);
  const json mesh = answer({"tensors", "builtin:cow@1"});
  const double size = mesh["principal_moments"][2];
  for (const std::string& file : {name, back}) {
    const json read = answer({"tensors", file});
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        CHECK(std::abs(read["inertia"][i][j].get<double>() - mesh["inertia"][i][j].get<double>()) < 1e-13 * size);
  }
  const std::vector<std::string> how = {"--length-unit", "2m", "--density", "1g/cm3", "--axis", "1,2,-3"};
  std::vector<std::string> of_mesh = {"radiate", "builtin:cow@1"}, of_file = {"radiate", back};
  of_mesh.insert(of_mesh.end(), how.begin(), how.end());
  of_file.insert(of_file.end(), how.begin(), how.end());
  const json a = answer(of_mesh), b = answer(of_file);
  for (const char* key : {"qdddot2_over_omega6", "power_W", "energy_J", "timescale_s", "deficit"})
    CHECK(b[key].get<double>() == Approx(a[key].get<double>()).epsilon(1e-12));
  CHECK(a["omega_after"].get<std::string>().substr(0, 30) == b["omega_after"].get<std::string>().substr(0, 30));
}

TEST_CASE("coefficients of the wrong kind are bad input, and a missing second moment is named", "[physics][cli]") {
  const TemporaryFolder folder;
  const std::string surface = folder / "surface.csv", potential = folder / "earth.gfc";
  REQUIRE(run_program({"expand", "builtin:cow@1", "--of", "smooth", "--lmax", "4", "--device", "cpu", "-o", surface})
              .exit_code == 0);
  for (const char* command : {"tensors", "radiate"}) refused({command, surface}, 3, "of a surface");
  const std::string low = folder / "low.csv";
  REQUIRE(run_program({"expand", "builtin:cow@1", "--lmax", "1", "--device", "cpu", "-o", low}).exit_code == 0);
  for (const char* command : {"tensors", "radiate"}) refused({command, low}, 3, "degree 1");
  {
    std::ofstream file(potential);
    file << "product_type gravity_field\nmodelname plain\nearth_gravity_constant 3.986004415e14\nradius "
            "6378136.3\nmax_degree 2\nnorm "
            "fully_normalized\nend_of_head\ngfc 0 0 1 0\ngfc 1 0 0 0\ngfc 1 1 0 0\ngfc 2 0 -4.84165e-4 0\ngfc 2 1 0 "
            "0\ngfc 2 2 2.439e-6 -1.4e-6\n";
  }
  refused({"tensors", potential}, 3, "second moment");
  const json waves = answer({"radiate", potential, "--axis", "z", "--period", "86164s"});
  CHECK(waves["power_W"].get<double>() > 0);
  CHECK(waves["timescale_s"].is_null());
  CHECK(waves["omega_after"].is_null());
  refused({"radiate", potential, "--octupole"}, 3, "--octupole");
  refused({"tensors", potential, "--rotate", "1,2,3"}, 2, "--rotate");
  refused({"tensors", potential, "--length-unit", "1m"}, 2, "already");
}

TEST_CASE("radiate says how a frequency is read, and refuses words that mean nothing", "[physics][cli]") {
  const std::vector<std::string> box = {"radiate", "builtin:box:1,2,3", "--length", "3m"};
  const auto with = [&](std::initializer_list<const char*> more) {
    std::vector<std::string> all = box;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const ProgramRun hertz = run_program(with({"--omega", "2Hz"}));
  CHECK(hertz.exit_code == 0);
  CHECK_THAT(hertz.out, Contains("2Hz is read as an angular frequency") && Contains(" 2 rad/s"));
  CHECK(answer(with({"--period", "1s"}))["omega_rad_per_s"].get<double>() == Approx(6.283185307179586).epsilon(1e-15));
  CHECK(answer(with({"--omega", "3rpm"}))["omega_rad_per_s"].get<double>() ==
        Approx(0.3141592653589793).epsilon(1e-15));
  refused(with({"--omega", "-1rad/s"}), 2, "above 0");
  refused(with({"--omega", "0Hz"}), 2, "above 0");
  refused(with({"--omega", "1"}), 2, "unit");
  refused(with({"--omega", "1kg"}), 2, "rad/s");
  refused(with({"--period", "0s"}), 2, "above 0");
  refused(with({"--period", "1s", "--omega", "1Hz"}), 2, "--period");
  refused(with({"--axis", "0,0,0"}), 2, "zero length");
  refused(with({"--axis", "w"}), 2, "--axis");
  refused(with({"--start", "14Gyr"}), 2, "--start");
  refused(with({"--age", "1m"}), 2, "Gyr");
  refused(with({"--omega", "1e9rad/s"}), 2, "faster than light");
  refused(with({"--length-unit", "1m"}), 2, "leave one out");
  refused({"radiate", "builtin:box", "--length", "3"}, 2, "3 of what");
  refused({"radiate", "builtin:box", "--length", "-3m"}, 2, "above 0");
  refused({"radiate", "builtin:box", "--part", "builtin:box=-1", "--origin", "mesh"}, 2, "centre of mass");
  refused({"radiate", "builtin:box", "--recipe", "paper", "--axis", "x"}, 2, "--recipe paper");
}

TEST_CASE("a body that is symmetric about its axis spins for ever, and one without units has no watts",
          "[physics][cli]") {
  const json ball =
      answer({"radiate", "builtin:sphere@3", "--length", "1m", "--density", "1g/cm3", "--omega", "7rad/s"});
  CHECK(ball["power_W"] == 0);
  CHECK(ball["timescale_s"].is_null());
  CHECK(ball["omega_after"] == "7");
  const json plain = answer({"radiate", "builtin:box:1,2,3", "--axis", "z", "--octupole"});
  CHECK(plain["qdddot2_over_omega6"].get<double>() == Approx(45 * 32.0 / 5 * 1.5 * 1.5).epsilon(1e-13));
  CHECK(plain["power_W"].is_null());
  CHECK(std::abs(plain["octupole_square_over_omega8"].get<double>()) < 1e-25);
}

TEST_CASE("the paper's recipe shows the paper's numbers beside ours", "[physics][cli][paper]") {
  if (!benchmark_cow()) return skip_without_cow();
  const json waves = answer({"radiate", "--recipe", "paper"});
  CHECK_THAT(waves["omega_after"].get<std::string>(), Catch::StartsWith("0.9999999999999999999999999999999889022"));
  for (const json& row : waves["paper"]) {
    INFO(row.dump());
    CHECK((std::abs(row["relative_difference"].get<double>()) < 1e-4 || !row["why"].get<std::string>().empty()));
  }
  CHECK(waves["paper"].size() == 11);
  const json tensors = answer({"tensors", "--recipe", "paper"});
  CHECK(tensors["paper"].size() == 17);
  for (const json& row : tensors["paper"]) {
    const std::string what = row["quantity"];
    if (what.find("inertia") == 0 && what.find('z') != std::string::npos && what != "inertia zz") continue;
    if (what == "quadrupole xz" || what == "quadrupole yz" || what.find("Q_22") != std::string::npos) continue;
    INFO(row.dump());
    CHECK(std::abs(row["relative_difference"].get<double>()) < 0.021);
  }
}
