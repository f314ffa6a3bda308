// Conventions of spherical-harmonic coefficients, and the way between them.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace cowgpu {

/// What the real harmonics U_lm = K_lm P_lm(cos theta) {cos m phi, sin m phi} are scaled to, by their mean square over the
/// sphere or by K_lm (P_lm without phase: P_11 = sin theta).
enum class Normalisation {
  orthonormal,  ///< integral of U^2 over the sphere = 1
  four_pi,      ///< integral of U^2 = 4 pi: geodesy
  schmidt,      ///< integral of U^2 = 4 pi / (2l + 1): Schmidt semi-normalised, geomagnetism
  unnormalised, ///< K_lm = 1
};

/// Whether the harmonics carry the Condon-Shortley phase (-1)^m.
enum class Phase { condon_shortley, none };

/// Two numbers C_lm, S_lm of real harmonics, or the one complex number of complex harmonics, m >= 0 held alone.
enum class Form { real, complex };

/// "orthonormal", "4pi", "schmidt", "unnormalised".
std::string_view name(Normalisation normalisation);
/// "cs", "none".
std::string_view name(Phase phase);
/// "real", "complex".
std::string_view name(Form form);
/// By the names above, or by pyshtools' "ortho" and "unnorm"; nothing for another word.
std::optional<Normalisation> normalisation_named(std::string_view word);
std::optional<Phase> phase_named(std::string_view word);
std::optional<Form> form_named(std::string_view word);

/// A convention of coefficients C_lm, S_lm of real fields
///   f = sum_{l, m >= 0} s_m K_lm P_lm(cos theta) (C_lm cos m phi + S_lm sin m phi),
/// s_m = (-1)^m with the Condon-Shortley phase and 1 without it. With a_lm as in SphereCoefficients, which fits the default,
/// C_lm - i S_lm = k_lm a_lm, and
///   k_lm = t_m sqrt(2 - delta_m0) N_l, t_m = 1 with the phase and (-1)^m without,
///   N_l = 1 (orthonormal), 1 / sqrt(4 pi) (4 pi), sqrt((2l + 1) / 4 pi) (Schmidt),
///   unnormalised: sqrt((2 - delta_m0) (2l + 1) / 4 pi * (l - m)! / (l + m)!) in the place of N_l.
/// Unnormalised coefficients underflow from about degree 150 on, and their harmonics overflow there.
struct Convention {
  Normalisation normalisation = Normalisation::orthonormal;
  Phase phase = Phase::condon_shortley;
  friend bool operator==(const Convention&, const Convention&) = default;
};

/// The part t_m g_m of k_lm (Convention) that depends on the order alone: t_m = 1 with the phase and (-1)^m without; g_m =
/// sqrt(2 - delta_m0) of real coefficients, 2 - delta_m0 of real unnormalised ones, 1 of complex ones.
long double order_factor(Convention convention, Form form, int m);

/// The other part n_lm of k_lm = t_m g_m n_lm: 1 (orthonormal), 1 / sqrt(4 pi) (4 pi), sqrt((2l + 1) / 4 pi) (Schmidt),
/// sqrt((2l + 1) / 4 pi * (l - m)! / (l + m)!) (unnormalised), one order after the other. The quotient of factorials leaves
/// the range of a long double near degree 870; the factor is 0 then.
class DegreeFactors {
public:
  DegreeFactors(Normalisation normalisation, int lmax);
  void start(int m);       ///< m = 0, 1, 2 ... in turn
  long double next(int l); ///< l = m, m + 1 ... in turn

private:
  bool quotients_;
  std::vector<long double> degree_;
  long double first_ = 1, quotient_ = 1; // 1 / (2m)!, (l - m)! / (l + m)!
  int order_ = 0;
};

} // namespace cowgpu
