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
  refused({"tides", surface, "--orbit", "1au"}, 3, "of a surface");
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
  const json known = answer({"tensors", potential});
  CHECK(known["inertia"].is_null());
  CHECK(known["principal_moments"].is_null());
  CHECK(known["quadrupole"][2][2].get<double>() < 0);
  CHECK(known["notes"].dump().find("second moment") != std::string::npos);
  refused({"tensors", potential, "--inertia"}, 3, "second moment");
  refused({"tides", potential, "--orbit", "1au"}, 3, "second moment");
  refused({"drop", potential, "--height", "1m"}, 3, "lowest point");
  const json waves = answer({"radiate", potential, "--axis", "z", "--period", "86164s"});
  CHECK(waves["power_W"].get<double>() > 0);
  CHECK(waves["timescale_s"].is_null());
  CHECK(waves["omega_after"].is_null());
  refused({"radiate", potential, "--octupole"}, 3, "--octupole");
  refused({"tensors", potential, "--rotate", "1,2,3"}, 2, "--rotate");
  CHECK(answer({"tensors", potential, "--length-unit", "1m"})["quadrupole"] == known["quadrupole"]);
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
  refused({"radiate", "builtin:box", "--length", "3"}, 2, "it needs a unit");
  refused({"radiate", "builtin:box", "--length", "-3m"}, 2, "above 0");
  refused({"radiate", "builtin:box", "--part", "builtin:box=-1", "--origin", "mesh"}, 2, "change --density");
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

TEST_CASE("rows without a value have a reason in a note and no line of their own", "[physics][cli]") {
  const ProgramRun plain = run_program({"radiate", "builtin:box:1,2,3"});
  CHECK(plain.exit_code == 0);
  CHECK_THAT(plain.out, !Contains("not known") && !Contains("unit of length ") && Contains("no unit was stated"));
  const ProgramRun cube = run_program({"radiate", "builtin:box:1,1,1", "--length", "1m", "--density", "1g/cm3"});
  CHECK_THAT(cube.out, Contains("never") && !Contains("inf"));
  const std::vector<std::string> fall = {"drop",   "builtin:box:1,2,3", "--length", "3m", "--density",
                                         "1g/cm3", "--height",          "9m"};
  std::vector<std::string> spun = fall;
  spun.insert(spun.end(), {"--spin", "x,1rad/s"});
  CHECK_THAT(run_program(fall).out, Contains("by torque t^2/2"));
  CHECK_THAT(run_program(spun).out, !Contains("by torque t^2/2") && !Contains("not known"));
}

TEST_CASE("a body lighter than nothing and a spin slower than anything are refused by name", "[physics][cli]") {
  for (const char* command : {"radiate", "tides", "drop"}) {
    std::vector<std::string> all = {command, "builtin:box:1,2,3", "--length-unit", "1m", "--density", "-1000"};
    if (command == std::string("tides")) all.insert(all.end(), {"--orbit", "7000km"});
    if (command == std::string("drop")) all.insert(all.end(), {"--height", "10m"});
    refused(all, 2, "weighs -6000 kg");
    refused(all, 2, "density");
  }
  refused({"radiate", "builtin:box:1,2,3", "--density", "-2"}, 2, "weighs -12:");
  const std::vector<std::string> box = {"radiate", "builtin:box:1,2,3", "--length-unit", "1m", "--density", "1g/cm3"};
  std::vector<std::string> slow = box, slower = box, tiny = box;
  slow.insert(slow.end(), {"--period", "100Gyr"});
  slower.insert(slower.end(), {"--period", "1e300s"});
  tiny[3] = "1e-16m";
  tiny.insert(tiny.end(), {"--period", "100Gyr"});
  CHECK(answer(slow)["power_W"].get<double>() > 0);
  CHECK(answer(slow)["omega_after"].get<std::string>().size() < 200);
  refused(slower, 2, "slower than a turn in 400 Gyr");
  slower.back() = "1e-20rad/s";
  slower[slower.size() - 2] = "--omega";
  refused(slower, 2, "--omega 1e-20rad/s");
  refused(tiny, 2, "doubles cannot hold");
  tiny[3] = "1e-40m";
  refused(tiny, 2, "too small or too large");
}

TEST_CASE("the paper's recipe lays its numbers beside no other body, however alike", "[physics][cli]") {
  for (std::vector<std::string> command : {std::vector<std::string>{"tensors"}, {"radiate"}, {"tip"}}) {
    command.insert(command.end(), {"builtin:box:1,2,3", "--recipe", "paper"});
    const json found = answer(command);
    INFO(command[0]);
    CHECK(found.count("paper") == 0);
    CHECK(found["notes"].dump().find("cannot be compared") != std::string::npos);
  }
  const json waves = answer({"radiate", "builtin:box:1,2,3", "--recipe", "paper"});
  CHECK(waves["length_unit_m"] == 2.39);
  if (!benchmark_cow()) return skip_without_cow();
  CHECK(answer({"tensors", "benchmark", "--recipe", "paper", "--rotate", "10,0,0"}).count("paper") == 0);
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

TEST_CASE("tides of a box in orbit: closed forms, from the mesh and from its coefficients", "[physics][cli]") {
  const TemporaryFolder folder;
  const std::string file = folder / "box.json";
  const std::vector<std::string> units = {"--length-unit", "1m", "--density", "3kg/m3", "--orbit", "8000km"};
  std::vector<std::string> of_mesh = {"tides", "builtin:box:1,2,3", "--attitude", "y:45"}, of_file = of_mesh;
  of_file[1] = file;
  REQUIRE(run_program({"expand", of_mesh[1], "--lmax", "6", "--device", "cpu", "-o", file}).exit_code == 0);
  of_mesh.insert(of_mesh.end(), units.begin(), units.end());
  of_file.insert(of_file.end(), units.begin(), units.end());
  const json a = answer(of_mesh), b = answer(of_file);
  const double least = 18 * 5 / 12.0, middle = 18 * 10 / 12.0, most = 18 * 13 / 12.0, gradient = 3.986004e14 / 5.12e20;
  const double n = a["rate_rad_per_s"];
  CHECK(n == Approx(std::sqrt(gradient)).epsilon(1e-13));
  CHECK(a["largest_torque"].get<double>() == Approx(1.5 * gradient * (most - least)).epsilon(1e-13));
  CHECK(std::abs(a["torque_quadrupole"][1].get<double>()) == Approx(1.5 * gradient * (most - least)).epsilon(1e-13));
  CHECK(a["pitch_period_s"].get<double>() ==
        Approx(2 * M_PI / n / std::sqrt(3 * (middle - least) / most)).epsilon(1e-13));
  CHECK(a["capture_half_width_rad_per_s"].get<double>() ==
        Approx(n * std::sqrt(3 * (middle - least) / most)).epsilon(1e-13));
  CHECK(a["equilibria"]["rows"].size() == 6);
  // In other units, where each degree has a scale of its own.
  for (auto* how : {&of_mesh, &of_file})
    for (std::string& word : *how) word = word == "1m" ? "7m" : word == "y:45" ? "y:25" : word;
  const json c = answer(of_mesh), d = answer(of_file);
  CHECK(c["torque_higher"][1].get<double>() != 0);
  CHECK(d["torque_higher"][1].get<double>() == Approx(c["torque_higher"][1].get<double>()).epsilon(1e-10));
  CHECK(a["equilibria"]["rows"][0][3] == "stable (Lagrange)");
  for (const char* key :
       {"pitch_period_s", "roll_yaw_slow_period_s", "roll_yaw_fast_period_s", "largest_torque", "mass_kg"})
    CHECK(b[key].get<double>() == Approx(a[key].get<double>()).epsilon(1e-11));
}

TEST_CASE("tides of a ball: nothing librates, and the report says so", "[physics][cli]") {
  const json ball = answer({"tides", "builtin:sphere@3", "--length", "1m", "--density", "1g/cm3", "--orbit", "1R_earth",
                            "--mass", "6e24kg", "--spin", "1rad/s", "--love", "1", "--quality", "10"});
  CHECK(ball["librates"] == false);
  CHECK(ball["pitch_period_s"].is_null());
  CHECK(ball["capture_half_width_rad_per_s"] == 0);
  CHECK(ball["locking_time_s"].get<double>() > 0);
  CHECK(ball.count("equilibria") == 0);
  CHECK(ball["notes"].dump().find("nothing librates") != std::string::npos);
}

TEST_CASE("a box that is dropped upside down lands on its feet with the spin that the report names", "[physics][cli]") {
  const std::vector<std::string> box = {"drop", "builtin:box:1,2,3", "--length-unit", "1m", "--height", "5m"};
  const auto with = [&](std::initializer_list<std::string> more) {
    std::vector<std::string> all = box;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const json still = answer(with({"--attitude", "upside-down"}));
  CHECK(still["lands_on_its_feet"] == false);
  CHECK(still["feet_tilt_before_deg"] == 180);
  CHECK(still["touches_with"] == "the end away from the feet");
  CHECK(still["touch_count"] == 1 + 3); // the whole face
  CHECK(still["fallen_m"].get<double>() == Approx(4).epsilon(1e-6));
  const double spin = still["spin_for_half_turn_rad_per_s"];
  const json turned = answer(with({"--attitude", "upside-down", "--spin", "x," + std::to_string(spin) + "rad/s"}));
  CHECK(turned["lands_on_its_feet"] == true);
  CHECK(turned["feet_tilt_after_deg"].get<double>() < 1);
  CHECK(turned["turn_first_order_rad"].is_null());
  const json slant = answer(with({"--attitude", "z:45"})), same = answer(with({"--attitude", "45,0,0"}));
  CHECK(slant["turn_rad"].get<double>() == Approx(same["turn_rad"].get<double>()).epsilon(1e-12));
  // About z, across the sides 1 and 2: 3/2 GM/r^3 (2^2 - 1^2)/(2^2 + 1^2) t^2/2.
  const double k = 3.986004e14 / std::pow(6371005.0, 3), t = slant["time_s"];
  CHECK(slant["turn_rad"].get<double>() == Approx(1.5 * k * 3 / 5 * t * t / 2).epsilon(1e-5));
  CHECK(slant["turn_first_order_difference"].get<double>() < 1e-5);
  CHECK(answer(with({"--feet", "x", "--attitude", "upright"}))["feet_tilt_after_deg"].get<double>() < 1e-3);
}

TEST_CASE("tides and drop name what they cannot use", "[physics][cli]") {
  const std::vector<std::string> units = {"--length", "2m", "--density", "1g/cm3"};
  const auto with = [&](std::vector<std::string> all, std::initializer_list<const char*> more) {
    all.insert(all.end(), units.begin(), units.end());
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const std::vector<std::string> tides = {"tides", "builtin:cow@1"}, drop = {"drop", "builtin:cow@1"};
  refused(tides, 2, "--orbit");
  refused(drop, 2, "--height");
  refused({"tides", "builtin:cow@1", "--orbit", "7000km"}, 2, "--length");
  refused({"drop", "builtin:cow@1", "--height", "7m"}, 2, "--density");
  refused(with(tides, {"--orbit", "1m"}), 3, "multipoles");
  refused(with(tides, {"--orbit", "-7000km"}), 2, "above 0");
  refused(with(tides, {"--orbit", "7000"}), 2, "unit");
  refused(with(tides, {"--orbit", "7000kg"}), 2, "R_earth");
  refused(with(tides, {"--orbit", "1au", "--mass", "0kg"}), 2, "above 0");
  refused(with(tides, {"--orbit", "1au", "--mass", "-2kg"}), 2, "above 0");
  refused(with(tides, {"--orbit", "1au", "--mass", "jupiter"}), 2, "earth, moon and sun");
  refused(with(tides, {"--orbit", "1au", "--attitude", "north"}), 2, "--attitude");
  refused(with(tides, {"--orbit", "1au", "--love", "1"}), 2, "--quality");
  for (const char* love : {"nan", "inf", "abc", "0.1kg", "0", "1e300"}) {
    const auto wrong = with(tides, {"--orbit", "7000km", "--spin", "1rad/s", "--quality", "10", "--love", love});
    refused(wrong, 2, "--love");
    CHECK_THAT(run_program(wrong).err, !Contains("lb"));
  }
  refused(with(tides, {"--orbit", "7000km", "--spin", "1rad/s", "--love", "0.1", "--quality", "1e300"}), 2,
          "--quality");
  refused(with(tides, {"--orbit", "1au", "--order", "1"}), 2, "--order");
  refused(with(drop, {"--height", "0.1m"}), 2, "touches the ground already");
  refused(with(drop, {"--height", "-1m"}), 2, "above 0");
  refused(with(drop, {"--height", "1e300m"}), 2, "lower --height");
  refused(with(drop, {"--height", "9m", "--spin", "x,1e6rad/s"}), 2, "lower --spin");
  refused(with(drop, {"--height", "9"}), 2, "unit");
  refused(with(drop, {"--height", "9m", "--attitude", "sideways"}), 2, "upside-down");
  refused(with(drop, {"--height", "9m", "--attitude", "x:abc"}), 2, "degrees");
  refused(with(drop, {"--height", "9m", "--spin", "1rad/s"}), 2, "AXIS,RATE");
  refused(with(drop, {"--height", "9m", "--feet", "0,0,0"}), 2, "zero length");
  for (const auto& command :
       {with(tides, {"--orbit", "1au"}), with(drop, {"--height", "9m"}), with({"radiate", "builtin:cow@1"}, {})}) {
    std::vector<std::string> hollow = command;
    hollow.insert(hollow.end(), {"--part", "builtin:cow@1=-1g/cm3"});
    refused(hollow, 2, "change --density");
  }
}
