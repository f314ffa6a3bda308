// Every number that the paper "Higher multipoles of the cow" prints and that the program lays beside its own: one table.
// `reproduce`, `errata` and --recipe paper show parts of it. The body is the mesh `benchmark`, with density 1, in the mesh's
// unit, about the centre of mass, x forward, y up, z to the right, unless a number's item says otherwise.
#pragma once

#include "host/physics/findings.hpp"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu::paper {

struct Printed {
  std::string table;                ///< "radiation"
  std::string item;                 ///< what it is, one of its kind in the table: "power in erg/s"
  std::vector<std::string> parts;   ///< as printed: a number, or real and imaginary part; of a formula twelve digits
  std::string unit = {};            ///< "erg/s"; empty for the mesh's units with density 1, and where there is none
  std::string reason = {};          ///< why ours differs: a sentence, or empty
  int erratum = 0;                  ///< the erratum that is about it (errata.hpp); 0: none
  int l = -1, m = 0, field = 0;     ///< degree and order of a coefficient, and the field of a surface's
  std::optional<double> value = {}; ///< value of a formula, to all digits
};

/// All of them, table by table: bounding box, mass multipoles, tensors, radiation, gradient flow, harmonic map, the spectrum,
/// tipping, and factors of the potential.
const std::vector<Printed>& printed();

/// One of them. Throws std::out_of_range where the paper has no such number.
const Printed& printed(std::string_view table, std::string_view item);

/// Its value, or its real part. Throws the same, and Error(bad_argument) for what is printed in words.
double number(std::string_view table, std::string_view item);

/// Ours beside it, with the reason.
physics::Comparison beside(std::string_view table, std::string_view item, double ours);

/// xx, xy, xz, yy, yz, zz of a symmetric tensor as printed, "quadrupole" or "inertia".
std::array<double, 6> tensor(std::string_view name);

/// Length of the average cow in m, from which the paper takes its unit of length.
inline constexpr double cow_length_m = 2.5;
/// The force in N that a human can keep up, and the punch of an elite boxer.
inline constexpr double sustained_force_N = 500, punch_N = 5000;

} // namespace cowgpu::paper
