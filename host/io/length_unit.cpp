#include "host/io/length_unit.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace cowgpu {
namespace {

struct KnownBody {
  const char* name;
  double radius; // km, as gravity fields refer to it
  double gm;     // km^3/s^2
  bool small;    // a body of no round shape: reference radii differ, and GM is known to some percent
};

// GM: JPL's DE440 and satellite ephemerides, and the missions to the small bodies.
constexpr KnownBody known_bodies[] = {
    {"the Sun", 695700, 1.32712440041e11, false},
    {"Mercury", 2440, 22031.87, false},
    {"Venus", 6051, 324858.6, false},
    {"the Earth", 6378, 398600.44, false},
    {"the Moon", 1738, 4902.8, false},
    {"Mars", 3396, 42828.37, false},
    {"Jupiter", 71492, 1.26686534e8, false},
    {"Saturn", 60268, 3.7931207e7, false},
    {"Uranus", 25559, 5793951, false},
    {"Neptune", 24764, 6835100, false},
    {"Pluto", 1188, 869.6, false},
    {"Io", 1821.5, 5959.9, false},
    {"Europa", 1561, 3202.7, false},
    {"Ganymede", 2632, 9887.8, false},
    {"Callisto", 2410, 7179.3, false},
    {"Enceladus", 252, 7.21, false},
    {"Tethys", 531, 41.21, false},
    {"Dione", 561, 73.11, false},
    {"Rhea", 764, 153.94, false},
    {"Titan", 2575, 8978.14, false},
    {"Triton", 1353, 1428.5, false},
    {"Ceres", 473, 62.63, false},
    {"Vesta", 265, 17.29, true},
    {"Eros", 16, 4.463e-4, true},
    {"Phobos", 11.3, 7.087e-4, true},
    {"Deimos", 6.3, 9.62e-5, true},
    {"comet 67P", 2, 6.66e-7, true},
    {"Bennu", 0.25, 4.89e-9, true},
    {"Ryugu", 0.45, 3.0e-8, true},
    {"Itokawa", 0.2, 2.4e-9, true},
};

bool about(double value, double expected, double relative) {
  return std::fabs(value - expected) <= relative * expected;
}

// The body of a radius in km and GM in km^3/s^2, or null.
const KnownBody* body_of(double radius, double gm) {
  const auto found = std::find_if(std::begin(known_bodies), std::end(known_bodies), [&](const KnownBody& body) {
    return about(radius, body.radius, body.small ? 0.6 : 0.02) && about(gm, body.gm, body.small ? 0.1 : 0.01);
  });
  return found == std::end(known_bodies) ? nullptr : &*found;
}

// The unit of length that is no metre, by the name people give it.
std::string unit_text(double metres) {
  return metres == 1000 ? "kilometres" : metres == 1 ? "metres" : fmt::format("units of {} m", metres);
}

[[noreturn]] void out_of_range(double unit, const std::string& what) {
  throw Error(
      Fault::bad_argument,
      fmt::format("--length-unit: in units of {} m {} beyond the range of doubles; state another unit", unit, what));
}

// Whether a number leaves the range of doubles when it is scaled.
bool is_lost(double value, double factor) {
  return value != 0 && !std::isnormal(value * factor);
}

} // namespace

void settle_length_unit(CoefficientSet& set, std::optional<double> metres, bool format_says_metres) {
  const double radius = set.reference_radius.value_or(0), gm = set.gm.value_or(0);
  set.length_unit = "m";
  set.mass_unit = "kg";
  set.gravitational_constant = gravitational_constant_si;
  double unit = 1;
  if (metres) {
    unit = *metres;
    set.notes.push_back(
        fmt::format("R = {} and GM = {} are taken in {}, as --length-unit says", radius, gm, unit_text(unit)));
  } else if (const KnownBody* body = body_of(radius, gm)) {
    unit = 1000;
    set.notes.push_back(
        fmt::format("the file does not say its unit of length: kilometres were taken, because R = {} and GM "
                    "= {} are those of {} in kilometres; --length-unit states another",
                    radius, gm, body->name));
  } else if (!format_says_metres) {
    const KnownBody* in_metres = body_of(radius / 1000, gm / 1e9);
    set.notes.push_back(
        fmt::format("the file does not say its unit of length: metres assumed{}; --length-unit km states "
                    "that R = {} and GM = {} are in kilometres",
                    in_metres ? fmt::format(", in which R and GM are those of {}", in_metres->name) : "", radius, gm));
  }
  if (unit == 1) return;
  const double volume = unit * unit * unit;
  if (!(unit > 0) || is_lost(radius, unit) || is_lost(gm, volume))
    out_of_range(unit, fmt::format("R = {} and GM = {} are", radius, gm));
  set.reference_radius = radius * unit;
  set.gm = gm * volume;
}

void state_length_unit(CoefficientSet& set, double metres, const std::string& file) {
  const auto refuse = [&](const char* why) {
    throw Error(Fault::bad_argument, fmt::format("--length-unit: {} {}", file, why));
  };
  if (set.in_metres()) refuse("is in metres already");
  const bool lengths = std::find(set.units.begin(), set.units.end(), "length") != set.units.end();
  if (set.kind == CoefficientKind::field && !lengths && !set.origin) refuse("holds no length");
  const double volume = metres * metres * metres;
  const std::string what = fmt::format("numbers of {} are", file);
  if (!(metres > 0)) out_of_range(metres, what);
  const auto scale = [&](std::optional<double>& value, double factor) {
    if (value && is_lost(*value, factor)) out_of_range(metres, what);
    if (value) *value *= factor;
  };
  if (set.kind == CoefficientKind::potential && set.gm) {
    const double mass = set.mass ? *set.mass : *set.gm / set.gravitational_constant.value_or(1);
    if (is_lost(mass, volume * gravitational_constant_si)) out_of_range(metres, what);
    set.gm = mass * volume * gravitational_constant_si;
  }
  scale(set.reference_radius, metres);
  scale(set.brillouin_radius, metres);
  scale(set.mass, volume);
  scale(set.second_moment, volume * metres * metres);
  if (set.origin) *set.origin *= metres;
  const std::size_t count = SphereCoefficients::count(set.lmax);
  for (std::size_t f = 0; f < std::size_t(set.fields); ++f) {
    const double factor = set.kind == CoefficientKind::multipoles ? volume : set.units[f] == "length" ? metres : 1;
    for (std::size_t i = f * count; i < (f + 1) * count; ++i) {
      set.first[i] *= factor;
      set.second[i] *= factor;
      if (!std::isfinite(set.first[i]) || !std::isfinite(set.second[i])) out_of_range(metres, what);
    }
  }
  set.length_unit = "m";
  if (set.kind == CoefficientKind::field) return;
  set.mass_unit = "kg";
  set.gravitational_constant = gravitational_constant_si;
}

} // namespace cowgpu
