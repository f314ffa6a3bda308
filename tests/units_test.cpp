#include "host/error.hpp"
#include "host/units.hpp"

#include <catch2/catch.hpp>

using namespace cowgpu;
using Catch::Contains;

TEST_CASE("quantities are numbers with or without a unit", "[units]") {
  const auto length = [](const char* text) { return parse_measure("--x", text, Dimension::length); };
  CHECK(length("12").value == 12);
  CHECK_FALSE(length("12").has_unit);
  CHECK(length("12 mm").value == 12e-3);
  CHECK(length("+2.5km").value == 2500);
  CHECK(length("-1e-3 m").value == -1e-3);
  CHECK(length("1R_earth").value == 6371e3);
  CHECK(length("3in").value == 3 * 0.0254);
  CHECK(length("3in").has_unit);
  const auto density = [](const char* text) { return parse_measure("--x", text, Dimension::density).value; };
  CHECK(density("2.5g/cm3") == 2500);
  CHECK(density("2.5 g/cm^3") == 2500);
  CHECK(density("300kg/m3") == 300);
  CHECK(density("-0.7t/m3") == -700);
  CHECK(density("62.4lb/ft3") == Approx(999.55).epsilon(1e-5));
}

TEST_CASE("quantities that mean nothing are refused with the units that there are", "[units]") {
  for (const char* text : {"", "m", "1 kg", "1kg/m3", "1e999m", "nan", "inf m", "1mm2", "1 M", "--1", "0x10", "1,5m"}) {
    INFO(text);
    CHECK_THROWS_WITH(parse_measure("--size", text, Dimension::length), Contains("--size") && Contains("R_earth"));
  }
  CHECK_THROWS_WITH(parse_measure("--density", "3 m", Dimension::density), Contains("no unit is called m"));
}
