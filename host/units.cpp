#include "host/units.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <charconv>
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
  const std::size_t sign = text.starts_with('+') ? 1 : 0; // from_chars takes none
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [next, error] = std::from_chars(text.data() + sign, end, value);
  if (error == std::errc::result_out_of_range) throw refuse("the number is out of range");
  if (error != std::errc()) throw refuse("there is no number");
  if (!std::isfinite(value)) throw refuse("the number is not finite");
  std::string unit;
  for (const char* c = next; c < end; ++c)
    if (*c != ' ' && *c != '^') unit += *c; // g/cm^3 as g/cm3
  if (unit.empty()) return {value, false, {}};
  for (const Unit& known : units)
    if (known.dimension == dimension && known.name == unit) return {value * known.in_si, true, known.name};
  throw refuse(fmt::format("no unit is called {}", unit));
}

} // namespace cowgpu
