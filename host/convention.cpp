#include "host/convention.hpp"

#include <cmath>
#include <numbers>

namespace cowgpu {
namespace {

using Real = long double;

} // namespace

std::string_view name(Normalisation normalisation) {
  switch (normalisation) {
  case Normalisation::orthonormal: return "orthonormal";
  case Normalisation::four_pi: return "4pi";
  case Normalisation::schmidt: return "schmidt";
  case Normalisation::unnormalised: return "unnormalised";
  }
  return "unknown";
}

std::string_view name(Form form) {
  return form == Form::real ? "real" : "complex";
}

std::string_view name(Phase phase) {
  return phase == Phase::condon_shortley ? "cs" : "none";
}

std::optional<Normalisation> normalisation_named(std::string_view word) {
  if (word == "ortho") return Normalisation::orthonormal;
  if (word == "unnorm") return Normalisation::unnormalised;
  for (const auto n :
       {Normalisation::orthonormal, Normalisation::four_pi, Normalisation::schmidt, Normalisation::unnormalised})
    if (word == name(n)) return n;
  return {};
}

std::optional<Phase> phase_named(std::string_view word) {
  for (const Phase phase : {Phase::condon_shortley, Phase::none})
    if (word == name(phase)) return phase;
  return {};
}

std::optional<Form> form_named(std::string_view word) {
  for (const Form form : {Form::real, Form::complex})
    if (word == name(form)) return form;
  return {};
}

long double order_factor(Convention convention, Form form, int m) {
  const Real sign = convention.phase == Phase::none && m % 2 ? -1 : 1;
  if (m == 0 || form == Form::complex) return sign;
  return sign * (convention.normalisation == Normalisation::unnormalised ? 2 : std::numbers::sqrt2_v<Real>);
}

DegreeFactors::DegreeFactors(Normalisation normalisation, int lmax)
    : quotients_(normalisation == Normalisation::unnormalised), degree_(std::size_t(lmax) + 1, 1) {
  const Real sphere = 4 * std::numbers::pi_v<Real>;
  for (int l = 0; l <= lmax; ++l) {
    Real& n = degree_[std::size_t(l)];
    if (normalisation == Normalisation::four_pi)
      n = 1 / std::sqrt(sphere);
    else if (normalisation != Normalisation::orthonormal)
      n = std::sqrt(Real(2 * l + 1) / sphere);
  }
}

void DegreeFactors::start(int m) {
  if (m > 0) first_ /= Real(2 * m - 1) * Real(2 * m);
  quotient_ = first_;
  order_ = m;
}

long double DegreeFactors::next(int l) {
  const Real n = degree_[std::size_t(l)];
  if (!quotients_) return n;
  const Real here = quotient_;
  quotient_ *= Real(l + 1 - order_) / Real(l + 1 + order_);
  return n * std::sqrt(here);
}

} // namespace cowgpu
