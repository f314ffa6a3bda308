#include "host/units.hpp"

#include "host/error.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

namespace cowgpu {
namespace {

struct Unit {
  Dimension dimension;
  std::string_view name;
  double in_si; // exact where it can be: the double next to the definition
};

constexpr Unit units[] = {
    {Dimension::length, "m", 1},
    {Dimension::length, "nm", 1e-9},
    {Dimension::length, "um", 1e-6},
    {Dimension::length, "mm", 1e-3},
    {Dimension::length, "cm", 1e-2},
    {Dimension::length, "km", 1e3},
    {Dimension::length, "in", 0.0254},
    {Dimension::length, "ft", 0.3048},
    {Dimension::length, "au", 149597870700.0},
    {Dimension::length, "R_earth", 6371e3},
    {Dimension::density, "kg/m3", 1},
    {Dimension::density, "g/cm3", 1e3},
    {Dimension::density, "g/m3", 1e-3},
    {Dimension::density, "kg/l", 1e3},
    {Dimension::density, "g/l", 1},
    {Dimension::density, "t/m3", 1e3},
    {Dimension::density, "lb/ft3", 0.45359237 / (0.3048 * 0.3048 * 0.3048)},
    {Dimension::time, "s", 1},
    {Dimension::time, "ms", 1e-3},
    {Dimension::time, "min", 60},
    {Dimension::time, "h", 3600},
    {Dimension::time, "d", 86400},
    {Dimension::time, "yr", julian_year},
    {Dimension::time, "kyr", 1e3 * julian_year},
    {Dimension::time, "Myr", 1e6 * julian_year},
    {Dimension::time, "Gyr", 1e9 * julian_year},
    {Dimension::angular_rate, "rad/s", 1},
    {Dimension::angular_rate, "deg/s", std::numbers::pi / 180},
    {Dimension::angular_rate, "rpm", std::numbers::pi / 30},
    {Dimension::angular_rate, "/s", 1},
    {Dimension::angular_rate, "Hz", 1},
    {Dimension::mass, "kg", 1},
    {Dimension::mass, "g", 1e-3},
    {Dimension::mass, "t", 1e3},
    {Dimension::mass, "lb", 0.45359237},
    {Dimension::force, "N", 1},
    {Dimension::force, "kN", 1e3},
    {Dimension::force, "kgf", 9.80665},
    {Dimension::force, "lbf", 0.45359237 * 9.80665},
    {Dimension::charge_density, "C/m3", 1},
    {Dimension::charge_density, "mC/m3", 1e-3},
    {Dimension::charge_density, "uC/m3", 1e-6},
    {Dimension::charge_density, "nC/m3", 1e-9},
    {Dimension::charge_density, "C/cm3", 1e6},
};

std::string names(Dimension dimension) {
  std::string text;
  for (const Unit& unit : units)
    if (unit.dimension == dimension) text += (text.empty() ? "" : ", ") + std::string(unit.name);
  return text;
}

} // namespace

Measure parse_measure(std::string_view option, std::string_view text, Dimension dimension) {
  const auto refuse = [&](const std::string& why) {
    return Error(Fault::bad_argument, fmt::format("{} {}: {}; it is a number with or without a unit of {}", option,
                                                  text, why, names(dimension)));
  };
  std::string_view rest = text;
  const auto number = take_number(rest);
  // Where there is none, or what is behind it begins as a number goes on: 1,5 and 0x10.
  const bool goes_on = number && (rest.starts_with(',') || rest.starts_with('.') || rest.starts_with('x') ||
                                  rest.starts_with('X') || (!rest.empty() && rest[0] >= '0' && rest[0] <= '9'));
  if (!number || goes_on) {
    const std::string why = not_a_number(text);
    throw refuse(why == "is not a number" || text.empty() ? "there is no number" : "the number " + why);
  }
  const double value = *number;
  std::string unit;
  for (const char c : rest)
    if (c != ' ' && c != '^') unit += c; // g/cm^3 as g/cm3
  if (unit.empty()) return {value, false, {}};
  for (const Unit& known : units)
    if (known.dimension == dimension && known.name == unit) {
      if (!std::isfinite(value * known.in_si)) throw refuse("it is beyond the range of doubles");
      return {value * known.in_si, true, known.name};
    }
  throw refuse(fmt::format("no unit is called {}", unit));
}

std::string_view meaning(std::string_view unit) {
  return unit == "R_earth" ? "R_earth is 6371 km, the earth's mean radius" : "";
}

} // namespace cowgpu
