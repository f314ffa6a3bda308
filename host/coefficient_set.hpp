// Spherical-harmonic coefficients as files carry them: the numbers of one convention, and what they are of.
#pragma once

#include "host/convention.hpp"
#include "host/sphere_coefficients.hpp"
#include "host/types.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cowgpu {

/// What coefficients are of. Each kind names a field on the unit sphere, f = sum a_lm Y_lm (Y_lm as in
/// SphereCoefficients); the numbers in a convention are coefficients of that field (host/convention.hpp).
enum class CoefficientKind {
  field,      ///< a_lm of any field
  multipoles, ///< mass multipoles: a_lm = conj(Q_lm) / R^l, Q_lm as in Multipoles; the complex form holds Q_lm / R^l itself
  /// the gravitational potential V = GM/r sum_lm (R/r)^l (C_lm cos m phi + S_lm sin m phi) K_lm P_lm(cos theta) of geodesy:
  ///   a_lm = 4 pi conj(Q_lm) / ((2l + 1) M R^l), f = V R / GM at r = R
  potential,
};

/// "field", "multipoles", "potential".
std::string_view name(CoefficientKind kind);
std::optional<CoefficientKind> kind_named(std::string_view word);

/// Name of the mass multipoles among the expansions of a result; surfaces have the names of their maps
/// (host/map/map_method.hpp).
inline constexpr const char* mass_expansion = "mass";

/// The length and mass unit of a body whose units nobody stated.
inline constexpr std::string_view mesh_length_unit = "of the mesh", mesh_mass_unit = "density times cubed length";

/// Newton's constant in m^3 / (kg s^2), CODATA 2018.
inline constexpr double gravitational_constant_si = 6.6743e-11;

/// Where coefficients come from. Empty: not known.
struct Provenance {
  std::string program;     ///< and its version
  std::string created;     ///< UTC, ISO 8601
  std::string command;     ///< as typed
  std::string mesh;        ///< name
  std::string mesh_sha256; ///< hash of the mesh's file
  std::string history;     ///< the commands that converted it since, separated by "; "
};

/// Coefficients with everything needed to read them. The numbers are those of the file, bit for bit.
struct CoefficientSet {
  int lmax = 0;
  int fields = 1;
  CoefficientKind kind = CoefficientKind::field;
  Form form = Form::real;
  Convention convention;
  bool normalisation_stated = true;  ///< false: the file does not say; what its format's users mostly take was assumed
  bool units_stated = true;          ///< false: of a potential; the format or its users' custom was followed
  bool phase_stated = true;          ///< as normalisation_stated
  std::vector<double> first, second; ///< C_lm and S_lm, or real and imaginary part; order as in SphereCoefficients

  std::vector<std::string> names;         ///< one a field, empty where there is none
  std::vector<std::string> units;         ///< the same; "length" and "radian" of surfaces
  std::optional<double> reference_radius; ///< R in the length unit; of multipoles and potentials
  /// Radius of the sphere about `origin` that holds the body, in the length unit: outside it the series is the potential. It
  /// says what R, which any number may be, does not. Empty: not known, as of files of other programs.
  std::optional<double> brillouin_radius;
  std::optional<Vec3> origin;         ///< origin of multipoles, potentials and surfaces, in mesh coordinates
  std::string origin_kind;            ///< "centre of mass", "mesh", "given", or empty
  std::string length_unit, mass_unit; ///< "m", "kg"; the two above; empty: not known
  std::optional<double> density, mass;
  std::optional<double> second_moment;          ///< integral of density r^2 about `origin`, in the units above
  std::optional<double> gravitational_constant; ///< G that went into gm, in the units above and seconds
  std::optional<double> gm;                     ///< G M of potentials
  Provenance provenance;
  std::vector<std::pair<std::string, std::string>> remarks; ///< what else the file says: a word, and a text

  std::vector<std::string> notes; ///< sentences of the reader: what was left out or assumed; no file holds them

  CoefficientSet() = default;
  CoefficientSet(int lmax_, int fields_)
      : lmax(lmax_), fields(fields_), first(std::size_t(fields_) * SphereCoefficients::count(lmax_)),
        second(first.size()), names(std::size_t(fields_)), units(std::size_t(fields_)) {}

  bool in_metres() const { return length_unit == "m"; }
  bool in_si() const { return in_metres() && mass_unit == "kg"; }

  /// Where (l, m) of field f stands in both.
  std::size_t index(int f, int l, int m) const {
    return std::size_t(f) * SphereCoefficients::count(lmax) + SphereCoefficients::index(lmax, l, m);
  }
};

} // namespace cowgpu
