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

TEST_CASE("times, rates and masses have units too, and say which one it was", "[units]") {
  const auto time = [](const char* text) { return parse_measure("--x", text, Dimension::time).value; };
  CHECK(time("24h") == time("1d"));
  CHECK(time("1yr") == 365.25 * 86400);
  CHECK(time("13.787Gyr") == Approx(13.787e9 * julian_year).epsilon(1e-15));
  CHECK(time("2min") == 120);
  const auto rate = [](const char* text) { return parse_measure("--x", text, Dimension::angular_rate); };
  CHECK(rate("1Hz").value == rate("1 rad/s").value);
  CHECK(rate("1/s").value == 1);
  CHECK(rate("1Hz").unit == "Hz");
  CHECK(rate("2").unit.empty());
  CHECK(rate("180deg/s").value == Approx(rate("30rpm").value).epsilon(1e-15));
  CHECK(parse_measure("--x", "2t", Dimension::mass).value == 2000);
  CHECK(parse_measure("--x", "2 nC/m3", Dimension::charge_density).value == 2e-9);
  CHECK(parse_measure("--x", "5kN", Dimension::force).value == 5000);
  CHECK(parse_measure("--x", "1lbf", Dimension::force).value == Approx(4.4482216152605).epsilon(1e-14));
  CHECK_THROWS_WITH(parse_measure("--x", "1 Myr", Dimension::mass), Contains("no unit is called Myr"));
}

TEST_CASE("quantities that mean nothing are refused with the units that there are", "[units]") {
  for (const char* text : {"", "m", "1 kg", "1kg/m3", "1e999m", "nan", "inf m", "1mm2", "1 M", "--1", "0x10", "1,5m"}) {
    INFO(text);
    CHECK_THROWS_WITH(parse_measure("--size", text, Dimension::length), Contains("--size") && Contains("R_earth"));
  }
  CHECK_THROWS_WITH(parse_measure("--density", "3 m", Dimension::density), Contains("no unit is called m"));
}
