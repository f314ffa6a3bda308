// Coefficients from one convention, kind, radius or frame to another.
#pragma once

#include "host/coefficient_set.hpp"
#include "host/spectrum/rotation.hpp"

#include <optional>
#include <string>

namespace cowgpu {

/// What is asked for; the rest stays as it is.
struct ConversionTarget {
  std::optional<CoefficientKind> kind = {};
  std::optional<Form> form = {};
  std::optional<Normalisation> normalisation = {};
  std::optional<Phase> phase = {};
  std::optional<double> reference_radius = {};
  std::optional<int> lmax = {}; ///< at most the set's
};

/// The numbers multiplied by the quotient of both conventions, by (R / R')^l and, between multipoles and potentials, by
/// 4 pi / ((2l + 1) M) or its inverse: one factor in long double and one rounding, so that there and back is right to 2
/// units in the last place, to degree 8192. Where nothing changes, the bits stay.
///
/// M is `mass`, else gm / G, else Q_00 sqrt(4 pi) of multipoles; both are filled in. G is gravitational_constant, else SI's
/// where the units are m and kg, else 1 (GM is then a mass in the mesh's units).
///
/// Throws Error(bad_argument) where that makes no sense (multipoles of a field, a radius of fields, no mass), and where a
/// coefficient that is not zero has no normal double: unnormalised ones from about degree 150 on, or far other radii.
CoefficientSet converted(const CoefficientSet& set, const ConversionTarget& target);

/// The fields turned by R, as the body that they are of about its origin: (Rf)(n) = f(R^-1 n), host/spectrum/rotation.hpp,
/// in the set's own convention. Throws what converted() and rotate() throw.
CoefficientSet rotated(const CoefficientSet& set, const EulerAngles& angles, Monitor& monitor, unsigned threads = 0);

/// Field `field` alone. Throws Error(bad_argument) where there is none of that name.
CoefficientSet single_field(const CoefficientSet& set, const std::string& field);

/// The numbers as complex coefficients, orthonormal, with the Condon-Shortley phase: a_lm of fields and potentials,
/// Q_lm / R^l of multipoles.
SphereCoefficients orthonormal(const CoefficientSet& set);

/// Fields as real coefficients C_lm, S_lm of a convention; imaginary parts of a_l0 are ignored. There and back is right to 4
/// units in the last place. Throws Error(bad_argument) as converted() does.
CoefficientSet set_of(const SphereCoefficients& coefficients, Convention convention);

} // namespace cowgpu
