#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

using namespace cowgpu::test;
using Catch::Contains;

namespace {

ProgramRun expand(std::vector<std::string> more) {
  std::vector<std::string> all = {"expand", "--device", "cpu", "--lmax", "4"};
  all.insert(all.end(), more.begin(), more.end());
  return run_program(all);
}

} // namespace

TEST_CASE("expand in SI: a box of 1 x 2 x 3 feet of water", "[body][cli]") {
  const ProgramRun run = expand({"builtin:box:1,2,3", "--length-unit", "ft", "--density", "1g/cm3"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("in metres and kilograms, density 1000 kg/m3"));
  CHECK_THAT(run.out, Contains("169.90107955")); // 6 * 0.3048^3 * 1000
  CHECK_THAT(run.out, Contains("kg m^l") && Contains("passed") && !Contains("FAILED"));
}

TEST_CASE("expand with parts says what each adds", "[body][cli]") {
  const ProgramRun run = expand({"builtin:box:3,3,3", "--density", "1000", "--part", "builtin:box:1,1,1=-700"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("part builtin:box:1,1,1") && Contains("density -700") && Contains("26300"));
  CHECK_THAT(run.out, Contains("passed") && !Contains("FAILED"));
}

TEST_CASE("body options that mean nothing are usage errors", "[body][cli]") {
  const auto refused = [](std::vector<std::string> arguments, const char* word) {
    const ProgramRun run = expand(arguments);
    INFO(run.err);
    CHECK(run.exit_code == 2);
    CHECK(run.out.empty());
    CHECK_THAT(run.err, Contains(word));
  };
  refused({"builtin:box", "--density", "300kg/m3"}, "--length-unit");
  refused({"builtin:box", "--length-unit", ""}, "the value is empty");
  refused({"builtin:box", "--density", "water"}, "kg/m3");
  refused({"builtin:box", "--density", "0"}, "density");
  refused({"builtin:box", "--length-unit", "3"}, "it needs a unit");
  refused({"builtin:box", "--length-unit", "-3m"}, "above 0");
  refused({"builtin:box", "--length-unit", "0m"}, "above 0");
  refused({"builtin:box", "--length-unit", "furlong"}, "furlong");
  refused({"builtin:box", "--axes", "y,x,z"}, "mirror image");
  refused({"builtin:box", "--rotate", "1,2"}, "--rotate");
  refused({"builtin:box", "--part", "builtin:box"}, "FILE=DENSITY");
  refused({"builtin:box", "--part", "=3"}, "FILE=DENSITY");
  refused({"builtin:box", "--part", "builtin:box="}, "FILE=DENSITY");
  refused({"builtin:box", "--part", "builtin:box=2kg/m3"}, "--length-unit");
  refused({"builtin:box", "--part", "builtin:box=-1"}, "--origin");
}

TEST_CASE("a part that is missing or broken is named", "[body][cli]") {
  const ProgramRun missing = expand({"builtin:box", "--part", "no-such.off=3"});
  CHECK(missing.exit_code == 5);
  CHECK_THAT(missing.err, Contains("--part no-such.off=3"));
  const ProgramRun open =
      expand({"builtin:box", "--part", std::string(COWGPU_SOURCE) + "/tests/corpus/refused/mesh-open--fin.off=3"});
  CHECK(open.exit_code == 3);
  CHECK_THAT(open.err, Contains("mesh-open") && Contains("fin.off"));
}

TEST_CASE("a quarter turn about x is the same by axes and by Euler angles", "[body][cli]") {
  const auto leading = [](std::vector<std::string> more) {
    more.insert(more.begin(), {"builtin:cow@1", "--origin", "mesh"});
    const ProgramRun run = expand(more);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return run.out.substr(run.out.find("leading"));
  };
  const std::string axes = leading({"--axes", "x,-z,y"});
  CHECK(axes == leading({"--rotate", "-90,90,90"}));
  CHECK(axes != leading({}));
  CHECK(leading({"--axes", "x,-z,y", "--rotate", "-90,-90,90"}) == leading({}));
}

TEST_CASE("whole turns beyond the first are left out exactly", "[body][cli]") {
  const ProgramRun once = expand({"builtin:box:1,2,3", "--rotate", "30,0,0"});
  const ProgramRun often = expand({"builtin:box:1,2,3", "--rotate", "36000000000030,0,0"});
  REQUIRE(often.exit_code == 0);
  CHECK(once.out.substr(once.out.find("leading")) == often.out.substr(often.out.find("leading")));
}

TEST_CASE("a map from a file is turned with the body: the same coefficients as a map made anew", "[body][cli]") {
  const TemporaryFolder folder;
  const std::string map = folder / "map.ply", made = folder / "made.csv", read = folder / "read.csv";
  REQUIRE(run_program({"map", "builtin:cow@1", "-q", "-o", map}).exit_code == 0);
  const std::vector<std::string> turned = {"builtin:cow@1", "--of", "stretch", "--rotate", "20,30,40", "-q"};
  auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), turned.begin(), turned.end());
    return expand(more).exit_code;
  };
  REQUIRE(with({"-o", made}) == 0);
  REQUIRE(with({"--map", map, "-o", read}) == 0);
  const ProgramRun difference = run_program({"diff", made, read, "--of", "stretch", "--tolerance", "1e-6"});
  INFO(difference.out << difference.err);
  CHECK(difference.exit_code == 0);
}

TEST_CASE("files of coefficients that were cut within a number are refused", "[body][cli]") {
  const TemporaryFolder folder;
  for (const char* name : {"cow.gfc", "cow.sh", "cow.csv"}) {
    INFO(name);
    const std::string path = folder / name;
    REQUIRE(expand({"builtin:cow@1", "-q", "-o", path}).exit_code == 0);
    std::string text = read_text(path);
    text.resize(text.size() - 8); // within the exponent's number: what is left is a number too
    write_text(path, text);
    const ProgramRun run = run_program({"convert", path, folder / "out.json"});
    CHECK(run.exit_code == 3);
    CHECK_THAT(run.err, Contains("file-truncated") || Contains("file-syntax"));
  }
  write_text(folder / "deep.json", std::string(100000, '['));
  const ProgramRun deep = run_program({"convert", folder / "deep.json", folder / "out.csv"});
  CHECK(deep.exit_code == 3);
  CHECK_THAT(deep.err, Contains("nested"));
}
