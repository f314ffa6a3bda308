// Units: those of a body or a file, and quantities with units as the command line takes them.
#pragma once

#include <string_view>

namespace cowgpu {

/// What a quantity measures. Values are held in the SI unit: m, kg/m3, s, rad/s, kg, C/m3, N.
enum class Dimension { length, density, time, angular_rate, mass, charge_density, force };

/// The units that a body, or what a file holds, is in. Where they are `stated` its numbers are SI, and a number of the file was
/// so many metres or kilograms; where not its numbers are in the file's own units, of which nothing is known.
struct Units {
  double metre = 1;    ///< metres that the file's unit of length is
  double kilogram = 1; ///< kilograms that its unit of mass is: of a mesh its density times the cube of that
  bool stated = false;
};

/// Seconds.
inline constexpr double julian_year = 365.25 * 86400;

/// A number and whether a unit came with it.
struct Measure {
  double value = 0; ///< in the SI unit if has_unit, else as given
  bool has_unit = false;
  std::string_view unit; ///< its name, as listed below; empty without one
};

/// Reads "2.7g/cm3", "2.7 g/cm^3", "300kg/m3", "12 km", "1e-3": a finite number and, next to it or after blanks, a unit or
/// none. Units of length: nm um mm cm m km in ft au R_earth (6371 km); of density: kg/m3 g/cm3 g/m3 kg/l g/l t/m3 lb/ft3;
/// of time: s ms min h d yr kyr Myr Gyr, a year being Julian, 365.25 days of 86400 s; of angular rate: rad/s deg/s rpm, and
/// /s and Hz, which are both 1 rad/s; of mass: kg g t lb; of charge density: C/m3 mC/m3 uC/m3 nC/m3 C/cm3; of force: N kN
/// kgf lbf.
/// `option` opens the messages. Throws Error(bad_argument) with the units that there are.
Measure parse_measure(std::string_view option, std::string_view text, Dimension dimension);

/// What a unit without one meaning everywhere stands for here: "R_earth is 6371 km, the earth's mean radius". Empty for others.
std::string_view meaning(std::string_view unit);

} // namespace cowgpu
