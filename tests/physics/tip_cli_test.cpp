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
  arguments.insert(arguments.begin(), "tip");
  arguments.insert(arguments.end(), {"--device", "cpu", "--json"});
  const ProgramRun run = run_program(arguments);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  return json::parse(run.out);
}

void refused(std::vector<std::string> arguments, int code, const char* word) {
  arguments.insert(arguments.begin(), "tip");
  const ProgramRun run = run_program(arguments);
  INFO(run.err);
  CHECK(run.exit_code == code);
  CHECK(run.out.empty());
  CHECK_THAT(run.err, Contains(word));
}

std::string written(const TemporaryFolder& folder, const char* name, const char* text) {
  const std::string path = folder / name;
  std::ofstream(path) << text;
  return path;
}

// 0.8 m along z, 2 m high, 60 kg: the threshold is 60 g 0.4/(2 r), r = sqrt(1.16) m.
const std::vector<std::string> crate = {"builtin:box:1,2,0.8", "--length-unit", "1m", "--density", "37.5kg/m3"};

std::vector<std::string> with(std::vector<std::string> first, const std::vector<std::string>& more) {
  first.insert(first.end(), more.begin(), more.end());
  return first;
}

constexpr double g = 9.80665;

} // namespace

TEST_CASE("tip of a box in newtons, and in its weight where no unit is stated", "[tip][cli]") {
  const double r = std::sqrt(1.16), force = 60 * g * 0.4 / (2 * r);
  const json metric = answer(crate);
  CHECK(metric["force_N"].get<double>() == Approx(force).epsilon(1e-13));
  CHECK(metric["force_N_paper_balance"].get<double>() == Approx(60 * g * 0.4 / (r + 0.16 / r)).epsilon(1e-13));
  CHECK(metric["weight_N"].get<double>() == Approx(60 * g).epsilon(1e-13));
  CHECK(metric["attitude"] == "settled");
  CHECK(metric["settle_angle_deg"] == 0);
  CHECK(metric["contact_patch"]["rows"].size() == 4);
  CHECK(metric["units"]["orders.force_N"] == "N");
  REQUIRE(metric["orders"].size() == 1);
  const json& full = metric["orders"][0];
  CHECK(full["order"] == "full");
  CHECK(full["side"] == "right");
  CHECK(full["force_N"] == metric["force_N"]);
  CHECK(full["pivot"] == metric["pivot"]);
  CHECK(full["point"] == metric["point"]);
  CHECK(full["force_left_N"].get<double>() == Approx(force).epsilon(1e-13));
  const json plain = answer({"builtin:box:1,2,0.8", "--side", "left"});
  CHECK(plain["force_N"].is_null());
  CHECK(plain["force_over_weight"].get<double>() == Approx(0.2 / r).epsilon(1e-13));
  CHECK(plain["force_over_weight_paper_balance"].get<double>() == Approx(0.4 / (r + 0.16 / r)).epsilon(1e-13));
  CHECK(plain["side"] == "left");
  CHECK_FALSE(plain.contains("boundary"));
  CHECK_THAT(plain["notes"].dump(), Contains("units of the body's weight"));
  const json moon = answer(with(crate, {"--gravity", "1.62"}));
  CHECK(moon["force_N"].get<double>() == Approx(force * 1.62 / g).epsilon(1e-13));
}

TEST_CASE("feet slip before the body tips below the friction coefficient that it needs", "[tip][cli]") {
  const double needed = answer(crate)["friction_needed"];
  const json smooth = answer(with(crate, {"--friction", std::to_string(needed - 1e-3)}));
  const json rough = answer(with(crate, {"--friction", std::to_string(needed + 1e-3)}));
  CHECK(smooth["slips_before_tipping"] == true);
  CHECK(smooth["slip_force_N"].get<double>() < smooth["force_N"].get<double>());
  CHECK(rough["slips_before_tipping"] == false);
  CHECK(rough["slip_force_N"].get<double>() > rough["force_N"].get<double>());
  CHECK(answer(with(crate, {"--friction", "0"}))["slip_force_N"] == 0);
}

TEST_CASE("a push that lasts: pulse and table, body and space, and the boundary between", "[tip][cli]") {
  const TemporaryFolder folder;
  const json found = answer(with(crate, {"--punch", "500N", "--sustained", "50N", "--punch-duration", "20ms"}));
  CHECK(found["sustained_tips"] == false);
  CHECK(found["punch_tips"] == false);
  const double least = found["punch_least_duration_s"];
  CHECK(found["punch_impulse_Ns"].get<double>() > found["least_impulse_Ns"].get<double>());
  CHECK(found["punch_force_needed_N"].get<double>() * 0.02 > found["least_impulse_Ns"].get<double>());
  const auto pulse = [&](double part) { return "500N:" + std::to_string(least * part) + "s"; };
  const json tips = answer(with(crate, {"--push", pulse(1.001), "--friction", "10"}));
  CHECK(tips["push_tips"] == true);
  CHECK(tips["push_slips"] == false);
  const json back = answer(with(crate, {"--push", pulse(0.999)}));
  CHECK(back["push_outcome"] == "lifts off and falls back");
  CHECK(back["push_peak_tilt_deg"].get<double>() < back["balance_angle_deg"].get<double>());
  const json space = answer(with(crate, {"--push-direction", "space", "--punch", "500N"}));
  CHECK(space["push_direction"] == "stays in space");
  CHECK(space["punch_least_duration_s"].get<double>() > least * (1 + 1e-5));
  const json never = answer(with(crate, {"--push", "50N:1h"}));
  CHECK(never["push_outcome"] == "never lifts off");
  CHECK(never["push_end_time_s"].is_null());
  const std::string table = written(folder, "push.csv", "time,force\n0,500\n0.05,500\n0.05,0\n9,0\n");
  const json by_table = answer(with(crate, {"--push", table})),
             by_pulse = answer(with(crate, {"--push", "500N:0.05s"}));
  CHECK(by_table["push_peak_tilt_deg"].get<double>() ==
        Approx(by_pulse["push_peak_tilt_deg"].get<double>()).epsilon(1e-9));
  const json& rows = found["boundary"]["rows"];
  CHECK(rows.size() == 19);
  std::size_t never_tips = 0;
  double force = 0;
  for (const json& row : rows) {
    CHECK(row[0].get<double>() >= force);
    force = row[0];
    never_tips += row[1].is_null();
  }
  CHECK(never_tips == 2); // 50 N and the threshold itself
}

TEST_CASE("what never happens is called so on the screen, and no unit follows what is not known", "[tip][cli]") {
  const auto screen = [](const std::vector<std::string>& arguments) {
    const ProgramRun run = run_program(with({"tip"}, arguments));
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    CHECK_THAT(run.out, !Catch::Matches("[^]*not known [^]*"));
    return run.out;
  };
  CHECK_THAT(screen(with(crate, {"--punch", "20N", "--push", "20N:1s", "--friction", "0.05"})),
             Contains("least duration of the punch            never") &&
                 Contains("time until it lifts off                never\n") && Contains("`grips` says") &&
                 Contains("feet held"));
  CHECK_THAT(screen({"builtin:box:1,2,0.8"}), Contains("not known\n"));
}

TEST_CASE("very long punches and the limits of gravity are followed to their end", "[tip][cli]") {
  const json found = answer(with(crate, {"--punch", "50000N", "--punch-duration", "1e9s"}));
  CHECK(found["punch_tips"] == true);
  CHECK(found["punch_force_needed_N"].get<double>() == Approx(found["force_N"].get<double>()).epsilon(1e-13));
  for (const char* gravity : {"1e-6", "1e13"}) {
    const json there = answer(with(crate, {"--gravity", gravity}));
    CHECK(there["force_N"].get<double>() / std::stod(gravity) ==
          Approx(found["force_N"].get<double>() / g).epsilon(1e-13));
  }
}

TEST_CASE("kilograms of a body whose density nobody stated come with a note", "[tip][cli]") {
  const auto noted = [](const std::vector<std::string>& arguments) {
    const ProgramRun run = run_program(with(arguments, {"--json"}));
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return json::parse(run.out)["notes"].dump().find("the density was not given: 1 kg/m3") != std::string::npos;
  };
  const std::vector<std::vector<std::string>> commands = {{"tip", "builtin:box:1,2,0.8"},
                                                          {"drop", "builtin:box:1,2,0.8", "--height", "9m"},
                                                          {"tides", "builtin:box:1,2,0.8", "--orbit", "7000km"}};
  for (const auto& command : commands) {
    INFO(command.front());
    CHECK(noted(with(command, {"--length-unit", "1m"})));
    CHECK_FALSE(noted(with(command, {"--length", "2m", "--density", "1"})));
  }
  CHECK_FALSE(noted(commands.front()));
}

TEST_CASE("tip with a hole is that of the solid surface, and a note says so", "[tip][cli]") {
  const TemporaryFolder folder;
  const std::string hole = written(folder, "hole.off", // below the crate
                                   "OFF\n4 4 0\n0 -2 0\n0.1 -1.9 0\n0 -1.9 0.1\n-0.1 -1.9 -0.1\n"
                                   "3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n");
  const json found = answer(with(crate, {"--part", hole + "=-1"})), plain = answer(crate);
  CHECK(found["pivot"][1] == plain["pivot"][1]);
  CHECK(found["support_points"] == 4);
  CHECK(found["mass_kg"].get<double>() < plain["mass_kg"].get<double>());
  CHECK_THAT(found["notes"].dump(), Contains("holes"));
}

TEST_CASE("tip at an order is stopped by an interrupt while it expands the surface", "[tip][cli]") {
  ProgramOptions options;
  options.interrupt_after = 0.5;
  const ProgramRun run =
      run_program({"tip", "builtin:box:1,2,3", "--order", "2", "--of", "flow", "--lmax", "256"}, options);
  CHECK(run.exit_code == 130);
  CHECK(run.out.empty());
  CHECK_THAT(run.err, Contains("[interrupted]"));
}

TEST_CASE("the boundary is drawn where there is one", "[tip][cli]") {
  const TemporaryFolder folder;
  const std::string picture = folder / "boundary.svg";
  const ProgramRun run = run_program(with(with({"tip"}, crate), {"--plot", picture, "--punch-duration", "20ms"}));
  CHECK(run.exit_code == 0);
  std::ifstream file(picture);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  CHECK_THAT(text, Contains("<svg"));
  refused(with(crate, {"--plot", folder / "boundary.gif"}), 2, "boundary.gif");
  refused({"builtin:box", "--plot", picture}, 2, "--length");
  refused(with(crate, {"--plot", folder / "nowhere/boundary.png"}), 5, "nowhere");
}

TEST_CASE("tip at orders of the expansion: the ball needs nothing, high orders what the body does", "[tip][cli]") {
  const json found = answer({"builtin:cow@2", "--length", "2.5m", "--density", "1g/cm3", "--order", "0,1,20,full"});
  const json& orders = found["orders"];
  REQUIRE(orders.size() == 4);
  CHECK(orders[0]["order"] == 0);
  CHECK(orders[0]["force_N"] == 0);
  CHECK(orders[0]["force_N_paper_balance"] == 0);
  CHECK(orders[0]["least_impulse_Ns"] == 0);
  CHECK(orders[1]["force_N"] == 0); // an ellipsoid rolls
  CHECK(orders[3]["order"] == "full");
  for (const json& entry : orders)
    for (const char* key : {"pivot", "point", "direction"}) CHECK(entry[key].size() == 3);
  CHECK(orders[2]["force_N"].get<double>() == Approx(orders[3]["force_N"].get<double>()).epsilon(0.25));
}

TEST_CASE("a ball as a smooth body is tipped by nothing; as a polyhedron it stands on a facet, and the note says so",
          "[tip][cli]") {
  const std::vector<std::string> ball = {"builtin:sphere:0.5@5", "--length-unit", "1m"};
  const json smooth = answer(with(ball, {"--smooth"}));
  CHECK(smooth["force_N"] == 0);
  CHECK(smooth["friction_needed"] == 0);
  CHECK_FALSE(smooth.contains("boundary"));
  CHECK_THAT(smooth["notes"].dump(), Contains("rolls over") && Contains("any push tips it"));
  const json facets = answer(ball);
  CHECK(facets["force_N"].get<double>() > 0);
  CHECK_THAT(facets["notes"].dump(), Contains("--smooth"));
  CHECK_THAT(answer(crate)["notes"].dump(), !Contains("--smooth"));
  CHECK(answer({"builtin:sphere:0.5@5", "--as-modelled"})["force_over_weight"] == 0);
}

TEST_CASE("an order that cannot stand as modelled has no force, and the row says why", "[tip][cli]") {
  const json found = answer({"builtin:cow@2", "--as-modelled", "--order", "0,3"});
  CHECK(found["orders"][0]["force_over_weight"] == 0);
  const json& third = found["orders"][1];
  for (const char* key : {"pivot", "point", "side", "force_N", "force_over_weight", "force_N_paper_balance"})
    CHECK(third[key].is_null());
  CHECK_THAT(third["note"].get<std::string>(), Contains("cannot stand") && Contains("falls to the"));
  CHECK(found["orders"][2]["force_over_weight"].get<double>() > 0.1);
}

TEST_CASE("tip from files of surface coefficients is that of the mesh's orders", "[tip][cli]") {
  const TemporaryFolder folder;
  const std::string result = folder / "cow.json", table = folder / "cow.csv", converted = folder / "cow.nc";
  REQUIRE(run_program({"expand", "builtin:cow@1", "--of", "smooth", "--lmax", "16", "--device", "cpu", "-o", result,
                       "-o", table})
              .exit_code == 0);
  REQUIRE(run_program({"convert", table, converted, "--of", "smooth", "--form", "real"}).exit_code == 0);
  const std::vector<std::string> unit = {"--length-unit", "2m", "--density", "1g/cm3", "--order", "0,8,16"};
  const json mesh = answer(with({"builtin:cow@1", "--of", "smooth", "--lmax", "16"}, unit));
  const json named = answer(with({result, "--mesh", "builtin:cow@1"}, unit));
  REQUIRE(mesh["orders"].size() == 4);
  CHECK(named["orders"][3]["force_N"].get<double>() ==
        Approx(mesh["orders"][3]["force_N"].get<double>()).epsilon(1e-12));
  CHECK(named["mass_kg"].get<double>() == Approx(mesh["mass_kg"].get<double>()).epsilon(1e-13));
  for (const std::string& file : {result, table, converted}) {
    const json found = answer(with({file}, unit));
    CHECK(found["input"]["kind"] == "coefficients");
    CHECK_THAT(found["body"].get<std::string>(), Contains("order 16"));
    for (std::size_t i = 0; i < 3; ++i)
      CHECK(found["orders"][i]["force_over_weight"].get<double>() ==
            Approx(mesh["orders"][i]["force_over_weight"].get<double>()).epsilon(1e-9));
    CHECK(found["orders"][2]["force_N"] == found["orders"][3]["force_N"]);
  }
}

TEST_CASE("tip refuses what it is not for, by name", "[tip][cli]") {
  const TemporaryFolder folder;
  const std::string mass = folder / "mass.json", csv = folder / "mass.csv", metric = folder / "metric.json";
  REQUIRE(run_program({"expand", "builtin:cow@1", "--lmax", "3", "--device", "cpu", "-o", mass, "-o", csv}).exit_code ==
          0);
  REQUIRE(run_program({"expand", "builtin:cow@1", "--of", "smooth", "--lmax", "3", "--length-unit", "1m", "--device",
                       "cpu", "-o", metric})
              .exit_code == 0);
  refused({mass}, 3, "no expansion of a surface");
  refused({csv}, 3, "coefficients of a mass");
  refused({metric, "--length-unit", "1m"}, 2, "in metres already");
  refused({metric, "--order", "4"}, 2, "degrees 0 to 3");
  refused({metric, "--rotate", "1,2,3"}, 2, "--rotate");
  refused({metric, "--lmax", "3"}, 2, "--lmax");
  refused({"builtin:box", "--mesh", "builtin:box"}, 2, "--mesh");
  refused({"builtin:box", "--of", "stretch"}, 2, "add --order");
  refused({"builtin:box", "--order", "99999"}, 2, "--order");
  refused({"builtin:box", "--order", "7", "--lmax", "3"}, 2, "beyond --lmax");
  refused({"builtin:box", "--order", "7..3"}, 2, "backwards");
  refused({"builtin:box", "--order", "2", "--of", "mass"}, 2, "--of mass");
  refused({"builtin:box", "--order", "64", "--resolution", "8"}, 2, "--resolution");
  refused({"builtin:box", "--side", "up"}, 2, "--side");
  refused({"builtin:box", "--friction", "-0.1"}, 2, "--friction");
  refused({"builtin:box", "--friction", "nan"}, 2, "--friction");
  for (const char* gravity : {"0", "1e-320", "1e308", "nan"})
    refused({"builtin:box", "--gravity", gravity}, 2, "--gravity");
  refused(with(crate, {"--punch", "1e-320N"}), 2, "--punch");
  refused(with(crate, {"--sustained", "1e300N"}), 2, "--sustained");
  refused(with(crate, {"--punch-duration", "1e300s"}), 2, "--punch-duration");
  refused({"builtin:box", "--length", "1e-12m"}, 2, "--length-unit");
  refused({"builtin:box:1,2,3", "--density", "-1", "--origin", "mesh"}, 2, "weighs -6");
  refused({"builtin:box:1,2,3", "--length-unit", "1m", "--density", "-1"}, 2, "weighs -6 kg");
  refused({"builtin:box:1,2,3", "--part", "builtin:box:1,2,3=-3"}, 2, "weighs -12");
  refused({metric, "--density", "-1"}, 2, "weighs");
  refused({"builtin:box", "--contact-tolerance", "-1"}, 2, "--contact-tolerance");
  refused({"builtin:box", "--contact-tolerance", "5mm"}, 2, "--length");
  refused({"builtin:box", "--push", "5N:1s"}, 2, "--length");
  const std::string open =
      written(folder, "open.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n");
  refused({open}, 3, "mesh-open");
  refused({"builtin:box:1,4,1", "--part", "builtin:box:1,4,1=-1"}, 2, "centre of mass");
}

TEST_CASE("tip refuses pushes that are none", "[tip][cli]") {
  const TemporaryFolder folder;
  const auto push = [&](const std::string& text, int code, const char* word) {
    refused(with(crate, {"--push", text}), code, word);
  };
  push("5000N", 2, "FORCE:DURATION");
  push("-5N:1s", 2, "above 0");
  push("5N:-1s", 2, "above 0");
  push("5N:0s", 2, "above 0");
  push("5:1s", 2, "unit");
  push("5N:1", 2, "unit");
  push("5kg:1s", 2, "kgf");
  push("nanN:1s", 2, "finite");
  push("1e31N:1s", 2, "the force is out of range");
  push("5N:1e10s", 2, "the duration is out of range");
  push("/dev/null", 2, "suffix .csv");
  push(folder.path(), 2, "suffix .csv");
  push(written(folder, "big.csv", "time,force\n0,1e308\n1e308,1e308\n"), 3, "big.csv:2");
  push(written(folder, "long.csv", "time,force\n0,10\n1e308,10\n"), 3, "long.csv:3");
  push(folder / "none.csv", 5, "none.csv");
  push(written(folder, "empty.csv", "time,force\n"), 3, "two rows");
  push(written(folder, "one.csv", "time,force\n0,5\n"), 3, "two rows");
  push(written(folder, "back.csv", "time,force\n0,5\n2,5\n1,5\n"), 3, "back.csv:4");
  push(written(folder, "pull.csv", "time,force\n0,5\n2,-5\n"), 3, "pull.csv:3");
  push(written(folder, "nan.csv", "time,force\n0,5\nnan,5\n"), 3, "nan.csv:3");
  push(written(folder, "names.csv", "force,time\n0,5\n1,5\n"), 3, "time,force");
  push(written(folder, "wide.csv", "time,force,x\n0,5,1\n1,5,1\n"), 3, "time,force");
}

TEST_CASE("a body that cannot stand as modelled is bad input, and stands once it has settled", "[tip][cli]") {
  const std::vector<std::string> tilted = {"builtin:box:1,4,1", "--rotate", "0,0,0"};
  CHECK(answer(with(tilted, {"--as-modelled"}))["attitude"] == "as modelled");
  // Turned by 30 degrees about x (R_z(90) R_y(30) R_z(-90)) it stands on one edge, the barycentre beside it.
  const std::vector<std::string> leaning = {"builtin:box:1,4,1", "--rotate", "-90,30,90"};
  refused(with(leaning, {"--as-modelled"}), 3, "cannot-stand");
  const json settled = answer(leaning);
  CHECK(settled["settle_angle_deg"].get<double>() == Approx(60).epsilon(1e-10)); // past the balance at 14 degrees
  CHECK(settled["force_over_weight"].get<double>() == Approx(2 / std::sqrt(17.0)).epsilon(1e-10));
}

TEST_CASE("the paper's recipe shows the paper's forces beside ours", "[tip][cli][paper]") {
  if (!benchmark_cow()) return skip_without_cow();
  const json found = answer({"--recipe", "paper"});
  CHECK(found["force_N"].get<double>() == Approx(1443.75).epsilon(1e-4));
  CHECK(found["sustained_tips"] == false);
  CHECK(found["sustained_short_by"].get<double>() == Approx(2.8875).epsilon(1e-4));
  CHECK(found["punch_least_duration_s"].get<double>() == Approx(0.109773).epsilon(1e-4));
  CHECK(found["least_impulse_Ns"].get<double>() == Approx(465.09).epsilon(1e-4));
  REQUIRE(found["paper"].size() == 7);
  CHECK(found["paper"][0]["ours"] == 0);
  for (std::size_t i = 1; i < 7; ++i) {
    INFO(found["paper"][i].dump());
    CHECK(found["paper"][i]["ours"].get<double>() > 2 * 500);
    CHECK_THAT(found["paper"][i]["why"].get<std::string>(), Contains("factor of a few"));
  }
}
