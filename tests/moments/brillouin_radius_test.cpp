// The radius of the sphere that holds a body, beside the reference radius of its coefficients: in files, conversions and places.
#include "host/error.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/physics/potential.hpp"
#include "tests/support/compare_potential.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using nlohmann::json;

namespace {

const double corner = std::sqrt(14.0) / 2; // of the box 1,2,3

void ok(const std::vector<std::string>& arguments) {
  const ProgramRun run = run_program(arguments);
  INFO(fmt::format("{}\n{}", fmt::join(arguments, " "), run.err));
  REQUIRE(run.exit_code == 0);
}

json answer(const std::string& command, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), command);
  arguments.push_back("--json");
  const ProgramRun run = run_program(arguments);
  INFO(fmt::format("{}\n{}", fmt::join(arguments, " "), run.err));
  REQUIRE(run.exit_code == 0);
  return json::parse(run.out);
}

std::string refused(std::vector<std::string> arguments, int code) {
  const ProgramRun run = run_program(arguments);
  INFO(fmt::format("{}\n{}", fmt::join(arguments, " "), run.err));
  CHECK(run.exit_code == code);
  CHECK(run.out.empty());
  return run.err;
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A file of another program: nothing that cowgpu says of it.
void forget(const std::string& from, const std::string& to) {
  std::istringstream lines(text_of(from));
  std::ofstream out(to);
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("#")) out << line << "\n";
}

const std::vector<std::string> formats = {".json", ".csv", ".nc", ".gfc", ".sh"};

} // namespace

TEST_CASE("every format carries the radius of the sphere that holds the body, through every conversion",
          "[brillouin][cli]") {
  const TemporaryFolder folder;
  std::vector<std::string> expand = {"expand", "builtin:box:1,2,3", "--lmax", "4", "--device", "cpu", "-q"};
  for (const std::string& format : formats) expand.insert(expand.end(), {"-o", folder / ("a" + format)});
  ok(expand);
  for (const std::string& from : formats)
    for (const std::string& to : formats) {
      INFO(from << " to " << to);
      const std::string file = folder / ("b" + to);
      ok({"convert", folder / ("a" + from), file, "--reference-radius", "10", "--rotate", "10,20,30", "-q"});
      const CoefficientSet set = read_coefficient_set(file);
      CHECK(set.reference_radius == 10);
      REQUIRE(set.brillouin_radius);
      CHECK(*set.brillouin_radius == Approx(corner).epsilon(1e-15));
    }
  ok({"expand", "builtin:box:1,2,3", "--lmax", "4", "--device", "cpu", "-q", "--length-unit", "2km", "-o",
      folder / "km.gfc"});
  CHECK(*read_coefficient_set(folder / "km.gfc").brillouin_radius == Approx(2000 * corner).epsilon(1e-15));
  ok({"convert", folder / "a.json", folder / "stated.json", "--length-unit", "2km", "-q"});
  CHECK(*read_coefficient_set(folder / "stated.json").brillouin_radius == Approx(2000 * corner).epsilon(1e-15));
}

TEST_CASE("places are judged by the sphere that holds the body, whatever the reference radius of its file",
          "[brillouin][cli]") {
  const TemporaryFolder folder;
  const std::string own = folder / "box.json";
  ok({"expand", "builtin:box:1,2,3", "--lmax", "24", "--device", "cpu", "-q", "-o", own});
  const json truth =
      answer("potential", {"builtin:box:1,2,3", "--order", "24", "--at", "2.5,0.5,-1", "--device", "cpu"});
  for (const char* radius : {"0.5", "1.9", "20"})
    for (const std::string& format : formats) {
      const std::string file = folder / (std::string("r") + radius + format);
      ok({"convert", own, file, "--reference-radius", radius, "-q"});
      INFO(file);
      const json found = answer("potential", {file, "--at", "2.5,0.5,-1", "--device", "cpu"});
      CHECK(found["potential"].get<double>() == Approx(truth["potential"].get<double>()).epsilon(1e-13));
      CHECK(found["acceleration"][2].get<double>() == Approx(truth["acceleration"][2].get<double>()).epsilon(1e-12));
      CHECK(found["brillouin_radius"].get<double>() == Approx(corner).epsilon(1e-14));
      CHECK(found["reference_radius"].get<double>() == std::stod(radius));
      CHECK_THAT(refused({"potential", file, "--at", "0.6,0,0", "--device", "cpu"}, 3),
                 Contains("inside the sphere of radius 1.87083"));
      const json sphere = answer("potential", {file, "--sphere", "1.5R", "--resolution", "3", "--device", "cpu"});
      CHECK_THAT(sphere["places"].get<std::string>(), Contains("sphere of radius 2.80624"));
    }
}

TEST_CASE(
    "of foreign files the sphere is not known, the output says so, and below the reference radius the field goes on",
    "[brillouin][cli]") {
  const TemporaryFolder folder;
  const std::string own = folder / "box.json";
  ok({"expand", "builtin:box:1,2,3", "--lmax", "24", "--device", "cpu", "-q", "--length-unit", "1m", "-o", own});
  const json truth = answer("potential", {own, "--at", "2.5,0.5,-1", "--device", "cpu"});
  for (const char* format : {".gfc", ".sh"}) {
    const std::string ours = folder / (std::string("ours") + format), wide = folder / (std::string("wide") + format),
                      narrow = folder / (std::string("narrow") + format);
    ok({"convert", own, ours, "--reference-radius", "4", "-q"});
    forget(ours, wide);
    ok({"convert", own, ours, "--reference-radius", "1", "-q"});
    forget(ours, narrow);
    INFO(format);
    for (const std::string& file : {wide, narrow}) {
      const json found = answer("potential", {file, "--at", "2.5,0.5,-1", "--device", "cpu"});
      CHECK(found["brillouin_radius"].is_null());
      CHECK(found["potential"].get<double>() == Approx(truth["potential"].get<double>()).epsilon(1e-12));
      CHECK_THAT(found["notes"].dump(), Contains("does not say the radius of the sphere that holds its body") &&
                                            Contains("--brillouin-radius"));
    }
    const std::string below = answer("potential", {wide, "--at", "2.5,0.5,-1", "--device", "cpu"})["notes"].dump();
    CHECK_THAT(below, Contains("continued downwards") && Contains("0.684653 reference radii"));
    const std::string above = answer("potential", {narrow, "--at", "2.5,0.5,-1", "--device", "cpu"})["notes"].dump();
    CHECK_THAT(above, !Contains("continued downwards"));
    // Stated, it keeps places out.
    CHECK_THAT(refused({"potential", wide, "--at", "0.6,0,0", "--brillouin-radius", "1.870829", "--device", "cpu"}, 3),
               Contains("inside the sphere of radius 1.87083"));
    CHECK(answer("potential", {wide, "--at", "2.5,0.5,-1", "--brillouin-radius", "187.0829cm", "--device",
                               "cpu"})["brillouin_radius"]
              .get<double>() == Approx(1.870829));
    // Where the terms grow with their degree no sum of them is a field.
    CHECK_THAT(refused({"potential", wide, "--at", "0.3,0,0", "--device", "cpu"}, 3),
               Contains("does not converge") && Contains("--order"));
    CHECK_THAT(refused({"potential", wide, "--at", "0,0,0", "--device", "cpu"}, 3), Contains("point-inside"));
    const std::string stated = folder / (std::string("stated") + format);
    ok({"convert", wide, stated, "--brillouin-radius", "1.870829", "-q"});
    CHECK(*read_coefficient_set(stated).brillouin_radius == 1.870829);
    refused({"convert", stated, folder / "x.json", "--brillouin-radius", "2"}, 2);
    refused({"potential", stated, "--at", "9,9,9", "--brillouin-radius", "2", "--device", "cpu"}, 2);
  }
  refused({"potential", "builtin:box", "--at", "9,9,9", "--brillouin-radius", "2", "--device", "cpu"}, 2);
  refused({"potential", folder / "wide.gfc", "--at", "9,9,9", "--brillouin-radius", "-1", "--device", "cpu"}, 2);
}

TEST_CASE("orbits and spins are judged by the sphere that holds the body, not by the reference radius",
          "[brillouin][cli]") {
  const TemporaryFolder folder;
  const std::string own = folder / "box.json", wide = folder / "wide.json", narrow = folder / "narrow.json";
  ok({"expand", "builtin:box:1,2,3", "--lmax", "6", "--device", "cpu", "-q", "--length-unit", "1km", "--density",
      "1g/cm3", "-o", own});
  ok({"convert", own, wide, "--reference-radius", "1e8", "-q"});
  ok({"convert", own, narrow, "--reference-radius", "100", "-q"});
  const auto orbit = [&](const std::string& file, const char* radius) {
    return std::vector<std::string>{"tides", file, "--orbit", radius, "--mass", "moon"};
  };
  ok(orbit(wide, "2000km"));
  CHECK_THAT(refused(orbit(narrow, "1.8km"), 3), Contains("runs inside the sphere of radius 1870.8"));
  CHECK_THAT(refused(orbit(wide, "1.8km"), 3), Contains("runs inside the sphere of radius 1870.8"));
  // 1e8 m at 3 rad/s and more would be light; the box is 1.9 km.
  ok({"radiate", wide, "--axis", "y", "--omega", "5rad/s"});
  CHECK_THAT(refused({"radiate", narrow, "--axis", "y", "--omega", "2e5rad/s"}, 2), Contains("faster than light"));
}

TEST_CASE("moments over another radius are those of the same body", "[brillouin]") {
  const Multipoles q = random_moments(9, 2, 1);
  const Multipoles there = physics::over_radius(q, 0.3), back = physics::over_radius(there, 2);
  CHECK(there.reference_radius == 0.3);
  for (std::size_t i = 0; i < q.values.size(); ++i) CHECK(std::abs(back.values[i] - q.values[i]) <= 4e-16);
  const std::vector<double> here = physics::degree_sizes(q, 5), same = physics::degree_sizes(there, 5);
  for (std::size_t l = 0; l < here.size(); ++l) CHECK(same[l] == Approx(here[l]).epsilon(1e-14));
  CHECK_THROWS_AS(physics::over_radius(q, 1e-60), Error);
  CHECK_THROWS_AS(physics::over_radius(q, 0), Error);
}
