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
  refused({"builtin:box", "--density", "water"}, "kg/m3");
  refused({"builtin:box", "--density", "0"}, "density");
  refused({"builtin:box", "--length-unit", "3"}, "3 of what");
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
