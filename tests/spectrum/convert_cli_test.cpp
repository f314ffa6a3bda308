#include "host/io/coefficient_file.hpp"
#include "host/spectrum/convert.hpp"
#include "host/spectrum/difference.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

void ok(const std::vector<std::string>& arguments) {
  const ProgramRun run = run_program(arguments);
  INFO(fmt::format("{}", fmt::join(arguments, " ")) << "\n" << run.err);
  REQUIRE(run.exit_code == 0);
}

std::string refused(const std::vector<std::string>& arguments, int code = 2) {
  const ProgramRun run = run_program(arguments);
  INFO(fmt::format("{}", fmt::join(arguments, " ")) << "\n" << run.err);
  CHECK(run.exit_code == code);
  return run.err;
}

void expand(const std::vector<std::string>& outputs, const std::vector<std::string>& more = {"--lmax", "20"}) {
  std::vector<std::string> arguments = {"expand", "builtin:cow@1", "--device", "cpu", "-q"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  for (const std::string& output : outputs) arguments.insert(arguments.end(), {"-o", output});
  ok(arguments);
}

// 4 units in the last place of each number.
void check_close(const CoefficientSet& a, const CoefficientSet& b) {
  REQUIRE(a.first.size() == b.first.size());
  for (std::size_t i = 0; i < a.first.size(); ++i) {
    CHECK(std::fabs(a.first[i] - b.first[i]) <= 4 * 0x1p-52 * std::fabs(a.first[i]));
    CHECK(std::fabs(a.second[i] - b.second[i]) <= 4 * 0x1p-52 * std::fabs(a.second[i]));
  }
}

} // namespace

TEST_CASE("expand writes every format, and all of them hold the same multipoles", "[convert-cli]") {
  const TemporaryFolder folder;
  const std::string json = folder / "c.json";
  const std::vector<std::string> others = {folder / "c.csv", folder / "c.gfc", folder / "c.sh", folder / "c.nc"};
  expand({json, others[0], others[1], others[2], others[3]});
  const CoefficientSet truth = read_coefficient_set(json);
  CHECK(truth.kind == CoefficientKind::multipoles);
  for (const std::string& other : others) {
    INFO(other);
    const CoefficientSet set = read_coefficient_set(other);
    CHECK(set.origin == truth.origin);
    CHECK(set.origin_kind == "centre of mass");
    CHECK(set.reference_radius == truth.reference_radius);
    CHECK(set.density == truth.density);
    CHECK(set.length_unit == "of the mesh");
    CHECK(set.provenance.mesh == "builtin:cow@1");
    CHECK(set.provenance.mesh_sha256.size() == 64);
    CHECK(set.provenance.command == truth.provenance.command);
    CHECK_THAT(set.provenance.program, StartsWith("cowgpu "));
    ConversionTarget target;
    target.kind = CoefficientKind::multipoles;
    target.form = Form::complex;
    target.normalisation = Normalisation::orthonormal;
    target.phase = Phase::condon_shortley;
    check_close(truth, converted(set, target));
    ok({"diff", json, other, "--tolerance", "1e-15"});
  }
}

TEST_CASE("what a file cannot hold is a usage error that says which can", "[convert-cli]") {
  const TemporaryFolder folder;
  const auto output = [&](const char* of, const char* name) {
    return refused({"expand", "builtin:cow@1", "--of", of, "--lmax", "3", "--device", "cpu", "-o", folder / name});
  };
  CHECK_THAT(output("stretch", "c.gfc"), Contains("gravity field") && Contains(".nc"));
  CHECK_THAT(output("stretch", "c.sh"), Contains("one field"));
  CHECK_THAT(output("mass,stretch", "c.nc"), Contains("one expansion"));
  CHECK_THAT(output("mass", "c.tif"), Contains(".gfc (ICGEM)"));
  expand({folder / "c.json"});
  const auto convert = [&](const char* name, const std::vector<std::string>& more, int code = 2) {
    std::vector<std::string> arguments = {"convert", folder / "c.json", folder / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return refused(arguments, code);
  };
  CHECK_THAT(convert("c.gfc", {"--form", "complex"}), Contains(".csv and .json"));
  CHECK_THAT(convert("c.gfc", {"--normalisation", "schmidt"}), Contains("not schmidt"));
  CHECK_THAT(convert("c.gfc", {"--phase", "cs"}), Contains("no Condon-Shortley phase"));
  CHECK_THAT(convert("c.gfc", {"--kind", "multipoles"}), Contains("mass multipoles go into"));
  CHECK_THAT(convert("c.csv", {"--of", "stretch"}), Contains("there is mass"));
  CHECK_THAT(convert("c.csv", {"--field", "x"}), Contains("there are mass"));
  CHECK_THAT(convert("c.csv", {"--lmax", "21"}), Contains("degree 20"));
  CHECK_THAT(convert("c.csv", {"--rotate", "1,2"}), Contains("ALPHA,BETA,GAMMA"));
  CHECK_THAT(convert("c.csv", {"--input-phase", "none"}),
             Contains("--input-phase none: ") && Contains("says cs itself"));
  CHECK_THAT(convert("c.json", {}), Contains("input and output at once"));
  for (const char* bad : {"x.gfc", "x.sh", "x.csv", "x.nc", "x.json"}) {
    write_text(folder / bad, "OFF\n0 0 0\n");
    CHECK_THAT(refused({"convert", folder / bad, folder / "y.csv"}, 3), Contains("error [file-"));
  }
  refused({"convert", folder / "none.gfc", folder / "y.csv"}, 5);
  CHECK_FALSE(std::filesystem::exists(folder / "y.csv"));
}

TEST_CASE("a way through every format and convention ends where it began", "[convert-cli]") {
  const TemporaryFolder folder;
  expand({folder / "0.json"});
  const auto step = [&](const char* in, const char* out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"convert", folder / in, folder / out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ok(arguments);
  };
  step("0.json", "1.gfc", {});
  step("1.gfc", "2.sh", {"--normalisation", "schmidt", "--phase", "cs", "--reference-radius", "0.7"});
  step("2.sh", "3.nc", {"--kind", "multipoles", "--normalisation", "orthonormal"});
  step("3.nc", "4.csv", {"--form", "complex", "--normalisation", "unnormalised"});
  step("4.csv", "5.json", {"--form", "real", "--phase", "none"});
  const CoefficientSet truth = read_coefficient_set(folder / "0.json");
  std::string radius = fmt::format("{}", *truth.reference_radius);
  step("5.json", "6.csv",
       {"--form", "complex", "--normalisation", "orthonormal", "--phase", "cs", "--reference-radius", radius});
  const CoefficientSet end = read_coefficient_set(folder / "6.csv");
  check_close(truth, end);
  CHECK(end.reference_radius == truth.reference_radius);
  CHECK(end.provenance.mesh_sha256 == truth.provenance.mesh_sha256);
  CHECK_THAT(end.provenance.history, Contains("1.gfc") && Contains("; ") && Contains("6.csv"));
}

TEST_CASE("a body is turned in degrees or radians, and back", "[convert-cli]") {
  const TemporaryFolder folder;
  expand({folder / "c.gfc"});
  ok({"convert", folder / "c.gfc", folder / "t.csv", "--rotate", "30,40,50"});
  ok({"convert", folder / "t.csv", folder / "b.sh", "--rotate", "-50,-40,-30"});
  ok({"diff", folder / "c.gfc", folder / "b.sh", "--tolerance", "1e-14"});
  ok({"convert", folder / "c.gfc", folder / "r.csv", "--angle-unit", "radians", "--rotate",
      "0.5235987755982988,0.6981317007977318,0.8726646259971648"});
  ok({"diff", folder / "t.csv", folder / "r.csv", "--tolerance", "1e-14"});
  const ProgramRun other = run_program({"diff", folder / "c.gfc", folder / "t.csv", "--tolerance", "1e-3"});
  CHECK(other.exit_code == 1);
  CHECK_THAT(other.out, Contains("beyond the tolerance"));
  CHECK_THAT(other.err, Contains("check-failed"));
  CHECK(run_program({"diff", folder / "c.gfc", folder / "t.csv"}).exit_code == 0);
  const CoefficientSet turned = read_coefficient_set(folder / "t.csv");
  REQUIRE(turned.remarks.size() == 1);
  CHECK_THAT(turned.remarks[0].second, Contains("30,40,50 degrees"));
  CHECK(turned.origin == read_coefficient_set(folder / "c.gfc").origin);
}

TEST_CASE("surfaces go into netCDF whole, and field by field into SHTOOLS text", "[convert-cli]") {
  const TemporaryFolder folder;
  expand({folder / "s.nc", folder / "s.json", folder / "s.csv"}, {"--of", "smooth", "--lmax", "5"});
  const CoefficientSet nc = read_coefficient_set(folder / "s.nc");
  CHECK(nc.fields == 6);
  CHECK(nc.names[0] == "f_r");
  CHECK(nc.units[1] == "radian");
  CHECK(nc.kind == CoefficientKind::field);
  ok({"diff", folder / "s.json", folder / "s.nc", "--of", "smooth", "--tolerance", "1e-15"});
  ok({"diff", folder / "s.csv", folder / "s.nc", "--of", "smooth", "--tolerance", "1e-15"});
  ok({"convert", folder / "s.json", folder / "f.sh", "--of", "smooth", "--field", "f_r"});
  ok({"diff", folder / "f.sh", folder / "s.nc", "--field", "f_r", "--tolerance", "1e-15"});
  CHECK_THAT(refused({"convert", folder / "s.nc", folder / "f.sh"}), Contains("--field"));
  const CoefficientSet json = read_coefficient_set(folder / "s.json", "smooth");
  CHECK(json.origin == nc.origin);
  CHECK_FALSE(json.remarks.empty());
}

TEST_CASE("degrees are left out, SI units stated, and a .sh file's convention given", "[convert-cli]") {
  const TemporaryFolder folder;
  expand({folder / "c.csv"});
  ok({"convert", folder / "c.csv", folder / "s.gfc", "--lmax", "4", "--si"});
  const CoefficientSet si = read_coefficient_set(folder / "s.gfc");
  CHECK(si.lmax == 4);
  CHECK(si.length_unit == "m");
  CHECK(*si.gm == *si.mass * 6.6743e-11);
  const ProgramRun degrees = run_program({"diff", folder / "c.csv", folder / "s.gfc"});
  CHECK_THAT(degrees.out, Contains("largest degree: 20 and 4") && Contains("length unit: of the mesh and m"));
  write_text(folder / "f.sh", "0 0 1\n1 0 2\n1 1 3 4\n");
  ok({"convert", folder / "f.sh", folder / "g.csv", "--input-normalisation", "schmidt", "--input-phase", "cs"});
  const CoefficientSet given = read_coefficient_set(folder / "g.csv");
  CHECK(given.convention == Convention{Normalisation::schmidt, Phase::condon_shortley});
  CHECK(given.second[given.index(0, 1, 1)] == 4);
}

TEST_CASE("what a file says of its convention counts: an option may say what it leaves open, or repeat it",
          "[convert-cli][gravity-table]") {
  const TemporaryFolder folder;
  const std::string rows = "2 0 -4.84e-4 0\n2 1 -2e-10 1.4e-9\n2 2 2.4e-6 -1.4e-6\n";
  write_text(folder / "t.tab", "1738.0 4902.8 0 2 2 1 0 0\n" + rows);
  const auto convert = [&](const char* in, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"convert", folder / in, folder / "o.csv", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  for (const char* other : {"unnormalised", "schmidt", "orthonormal"})
    CHECK_THAT(refused(convert("t.tab", {"--input-normalisation", other})),
               Contains(fmt::format("--input-normalisation {}: ", other)) && Contains("says 4pi itself"));
  CHECK_FALSE(std::filesystem::exists(folder / "o.csv"));
  const ProgramRun phase = run_program(convert("t.tab", {"--input-normalisation", "4pi", "--input-phase", "cs"}));
  CHECK(phase.exit_code == 0);
  CHECK(read_coefficient_set(folder / "o.csv").convention ==
        Convention{Normalisation::four_pi, Phase::condon_shortley});
  CHECK_THAT(phase.out, Contains("taken as 4pi, as the file says, and with the Condon-Shortley phase, as the option") &&
                            !Contains("was assumed") && Contains("from: potential to degree 2, real, 4pi, with"));
  // A model without the line `norm` takes the option, one with it does not.
  std::string model = "product_type gravity_field\nearth_gravity_constant 4902.8e9\nradius 1738e3\nmax_degree 2\n"
                      "norm fully_normalized\nend_of_head\n"
                      "gfc 0 0 1 0\ngfc 2 0 -4.84e-4 0\ngfc 2 1 -2e-10 1.4e-9\ngfc 2 2 2.4e-6 -1.4e-6\n";
  write_text(folder / "m.gfc", model);
  CHECK_THAT(refused(convert("m.gfc", {"--input-normalisation", "unnormalised"})), Contains("says 4pi itself"));
  write_text(folder / "m.gfc", replaced(model, "norm fully_normalized\n", ""));
  const ProgramRun norm = run_program(convert("m.gfc", {"--input-normalisation", "unnormalised"}));
  CHECK(norm.exit_code == 0);
  CHECK(read_coefficient_set(folder / "o.csv").convention == Convention{Normalisation::unnormalised, Phase::none});
  CHECK_THAT(norm.out, Contains("taken as unnormalised, as the option says") && !Contains("was assumed"));
  CHECK_THAT(refused(convert("m.gfc", {"--input-phase", "cs"})), Contains("says none itself"));
  // Half of it said: the other half is still assumed, and the note says which.
  write_text(folder / "f.sh", "0 0 1\n1 0 2\n1 1 3 4\n");
  const ProgramRun half = run_program(convert("f.sh", {"--input-normalisation", "schmidt"}));
  CHECK_THAT(half.out, Contains("taken as schmidt, as the option says, and without the Condon-Shortley phase, as was "
                                "assumed"));
}
