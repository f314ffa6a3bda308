#include "host/convention.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace cowgpu {
namespace {

using Real = long double;

[[noreturn]] void refuse(Convention convention, int l, int m) {
  throw Error(Fault::bad_argument,
              fmt::format("the coefficient of degree {} and order {} fits no double between the {} convention and the "
                          "orthonormal one{}",
                          l, m, name(convention.normalisation),
                          convention.normalisation == Normalisation::unnormalised
                              ? ": unnormalised coefficients leave the range of a double near degree 150; lower the "
                                "degree, or take another normalisation"
                              : "; scale the field down"));
}

double checked(Real value, double from, Convention convention, int l, int m) {
  if (from == 0) return 0;
  const auto result = double(value);
  const bool lost =
      convention.normalisation == Normalisation::unnormalised && std::fabs(result) < std::numeric_limits<double>::min();
  if (lost || !std::isfinite(result)) refuse(convention, l, m);
  return result;
}

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

RealCoefficients to_real(const SphereCoefficients& coefficients, Convention convention) {
  RealCoefficients real(coefficients.lmax, coefficients.fields, convention);
  DegreeFactors factors(convention.normalisation, coefficients.lmax);
  for (int m = 0; m <= coefficients.lmax; ++m) {
    factors.start(m);
    for (int l = m; l <= coefficients.lmax; ++l) {
      const Real k = order_factor(convention, Form::real, m) * factors.next(l);
      for (int f = 0; f < coefficients.fields; ++f) {
        const std::complex<double> a = coefficients.at(f, l, m);
        const std::size_t at = real.index(f, l, m);
        real.cosine[at] = checked(k * a.real(), a.real(), convention, l, m);
        if (m > 0) real.sine[at] = checked(-k * a.imag(), a.imag(), convention, l, m);
      }
    }
  }
  return real;
}

SphereCoefficients to_complex(const RealCoefficients& real) {
  SphereCoefficients coefficients(real.lmax, real.fields);
  DegreeFactors factors(real.convention.normalisation, real.lmax);
  for (int m = 0; m <= real.lmax; ++m) {
    factors.start(m);
    for (int l = m; l <= real.lmax; ++l) {
      const Real k = order_factor(real.convention, Form::real, m) * factors.next(l);
      for (int f = 0; f < real.fields; ++f) {
        const std::size_t at = real.index(f, l, m);
        const double c = real.cosine[at], s = m > 0 ? real.sine[at] : 0;
        coefficients.at(f, l, m) = {checked(c / k, c, real.convention, l, m),
                                    checked(-s / k, s, real.convention, l, m)};
      }
    }
  }
  return coefficients;
}

} // namespace cowgpu
