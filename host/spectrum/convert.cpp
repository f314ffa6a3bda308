#include "host/spectrum/convert.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace cowgpu {
namespace {

using Real = long double;

constexpr Real sphere = 4 * std::numbers::pi_v<Real>;

// (from / to)^l, right to the last place or two of a long double: powers of numbers in [1/2, 1), which are exact, and an
// exact power of two.
class RadiusPowers {
public:
  RadiusPowers(double from, double to) : same_(from == to) {
    int e = 0, f = 0;
    from_ = std::frexp(from, &e);
    to_ = std::frexp(to, &f);
    exponent_ = e - f;
  }
  Real operator()(int l) const {
    if (same_) return 1;
    return std::ldexp(std::pow(from_, Real(l)) / std::pow(to_, Real(l)), l * exponent_);
  }

private:
  bool same_;
  Real from_ = 1, to_ = 1;
  int exponent_ = 0;
};

[[noreturn]] void refuse(const CoefficientSet& from, const CoefficientSet& to, int l, int m) {
  const bool unnormalised = from.convention.normalisation != to.convention.normalisation &&
                            (from.convention.normalisation == Normalisation::unnormalised ||
                             to.convention.normalisation == Normalisation::unnormalised);
  throw Error(Fault::bad_argument,
              fmt::format("the coefficient of degree {} and order {} fits no double after the conversion{}", l, m,
                          unnormalised ? ": unnormalised coefficients leave the range of a double near degree 150; "
                                         "lower the degree with --lmax, or take another normalisation"
                                       : "; lower the degree with --lmax, or take a reference radius nearer to the "
                                         "file's"));
}

double product(Real factor, double value, const CoefficientSet& from, const CoefficientSet& to, int l, int m) {
  if (value == 0) return 0;
  const auto result = double(factor * value);
  constexpr double smallest = std::numeric_limits<double>::min();
  if (!std::isfinite(result) || (std::fabs(result) < smallest && std::fabs(value) >= smallest)) refuse(from, to, l, m);
  return result;
}

// Of a set that is asked for what only bodies have.
double mass_of(const CoefficientSet& set) {
  if (set.mass) return *set.mass;
  if (set.gm && set.gravitational_constant) return *set.gm / *set.gravitational_constant;
  if (set.kind == CoefficientKind::multipoles) {
    const SphereCoefficients q = orthonormal(set);
    return double(std::sqrt(sphere) * Real(q.at(0, 0, 0).real()));
  }
  throw Error(Fault::bad_argument, "these potential coefficients say neither a mass nor the constant G in their GM, so "
                                   "no multipoles can be computed from them; --si takes metres and kilograms");
}

double gravitational_constant(const CoefficientSet& set) {
  if (set.gravitational_constant) return *set.gravitational_constant;
  return set.in_si() ? gravitational_constant_si : 1;
}

void change_kind(const CoefficientSet& set, CoefficientSet& result, CoefficientKind kind) {
  if (kind == set.kind) return;
  if (set.kind == CoefficientKind::field || kind == CoefficientKind::field)
    throw Error(Fault::bad_argument,
                fmt::format("these are coefficients of kind {}, and {} is another thing; only multipoles and the "
                            "potential of a body come from one another",
                            name(set.kind), name(kind)));
  if (!set.reference_radius) throw Error(Fault::bad_argument, "these coefficients do not say their reference radius");
  const double mass = mass_of(set);
  if (!(mass != 0))
    throw Error(Fault::bad_argument, "the body's mass is 0, and coefficients of the potential are divided by it; the "
                                     "multipoles can be written to .json and .csv, and by `cowgpu convert` to .nc");
  result.kind = kind;
  result.mass = mass;
  result.gravitational_constant = gravitational_constant(set);
  if (kind == CoefficientKind::potential) result.gm = set.gm ? *set.gm : mass * *result.gravitational_constant;
}

// Of the imaginary part of a_lm in the second number.
int sign(const CoefficientSet& set) {
  return set.form == Form::real || set.kind == CoefficientKind::multipoles ? -1 : 1;
}

} // namespace

CoefficientSet converted(const CoefficientSet& set, const ConversionTarget& target) {
  const int lmax = target.lmax.value_or(set.lmax);
  if (lmax < 0 || lmax > set.lmax)
    throw Error(
        Fault::bad_argument,
        fmt::format("degree {} is not among coefficients that go to degree {}: ask for no higher one", lmax, set.lmax));
  CoefficientSet result = set;
  if (lmax < set.lmax) {
    result.lmax = lmax;
    result.first.assign(std::size_t(set.fields) * SphereCoefficients::count(lmax), 0);
    result.second = result.first;
  }
  result.form = target.form.value_or(set.form);
  result.convention = {target.normalisation.value_or(set.convention.normalisation),
                       target.phase.value_or(set.convention.phase)};
  if (target.kind) change_kind(set, result, *target.kind);
  if (target.reference_radius) {
    if (set.kind == CoefficientKind::field || !set.reference_radius)
      throw Error(Fault::bad_argument, "these coefficients are of fields on a sphere, which have no reference radius; "
                                       "only those of mass multipoles and potentials can be brought to another one");
    if (!(*target.reference_radius > 0) || !std::isfinite(*target.reference_radius))
      throw Error(Fault::bad_argument,
                  fmt::format("the reference radius is {}; it must be above 0", *target.reference_radius));
    result.reference_radius = target.reference_radius;
  }

  const bool same = set.convention.normalisation == result.convention.normalisation;
  const RadiusPowers radius(set.reference_radius.value_or(1), result.reference_radius.value_or(1));
  std::vector<Real> degree(std::size_t(lmax) + 1);
  for (int l = 0; l <= lmax; ++l) {
    Real& k = degree[std::size_t(l)];
    k = radius(l);
    if (result.kind == set.kind) continue;
    const Real body = sphere / (Real(2 * l + 1) * Real(*result.mass));
    k = result.kind == CoefficientKind::potential ? k * body : k / body;
  }
  DegreeFactors from(set.convention.normalisation, lmax), to(result.convention.normalisation, lmax);
  const int turn = sign(set) * sign(result);
  for (int m = 0; m <= lmax; ++m) {
    from.start(m);
    to.start(m);
    const Real order = order_factor(result.convention, result.form, m) / order_factor(set.convention, set.form, m);
    for (int l = m; l <= lmax; ++l) {
      Real k = order * degree[std::size_t(l)];
      if (!same) k *= to.next(l) / from.next(l);
      for (int f = 0; f < set.fields; ++f) {
        const std::size_t i = set.index(f, l, m), j = result.index(f, l, m);
        result.first[j] = product(k, set.first[i], set, result, l, m);
        result.second[j] = product(turn * k, set.second[i], set, result, l, m);
      }
    }
  }
  return result;
}

SphereCoefficients orthonormal(const CoefficientSet& set) {
  ConversionTarget target;
  target.form = Form::complex;
  target.normalisation = Normalisation::orthonormal;
  target.phase = Phase::condon_shortley;
  const CoefficientSet complex = converted(set, target);
  SphereCoefficients a(set.lmax, set.fields);
  for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] = {complex.first[i], complex.second[i]};
  return a;
}

CoefficientSet set_of(const SphereCoefficients& coefficients, Convention convention) {
  CoefficientSet complex(coefficients.lmax, coefficients.fields);
  complex.form = Form::complex;
  for (int f = 0; f < coefficients.fields; ++f)
    for (int m = 0; m <= coefficients.lmax; ++m)
      for (int l = m; l <= coefficients.lmax; ++l) {
        const std::complex<double> a = coefficients.at(f, l, m);
        complex.first[complex.index(f, l, m)] = a.real();
        complex.second[complex.index(f, l, m)] = m == 0 ? 0 : a.imag();
      }
  ConversionTarget target;
  target.form = Form::real;
  target.normalisation = convention.normalisation;
  target.phase = convention.phase;
  return converted(complex, target);
}

CoefficientSet rotated(const CoefficientSet& set, const EulerAngles& angles, Monitor& monitor, unsigned threads) {
  SphereCoefficients a = orthonormal(set);
  // Q_lm is the integral over Y_lm, and a_lm that over its conjugate.
  const bool conjugate = set.kind == CoefficientKind::multipoles;
  if (conjugate)
    for (auto& value : a.values) value = std::conj(value);
  a = rotate(a, angles, monitor, threads);
  CoefficientSet complex = set;
  complex.form = Form::complex;
  complex.convention = {};
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    complex.first[i] = a.values[i].real();
    complex.second[i] = conjugate ? -a.values[i].imag() : a.values[i].imag();
  }
  ConversionTarget back;
  back.form = set.form;
  back.normalisation = set.convention.normalisation;
  back.phase = set.convention.phase;
  return converted(complex, back);
}

CoefficientSet single_field(const CoefficientSet& set, const std::string& field) {
  for (int f = 0; f < set.fields; ++f) {
    if (set.names[std::size_t(f)] != field) continue;
    CoefficientSet one = set;
    const auto count = std::ptrdiff_t(SphereCoefficients::count(set.lmax));
    one.fields = 1;
    one.first.assign(set.first.begin() + f * count, set.first.begin() + (f + 1) * count);
    one.second.assign(set.second.begin() + f * count, set.second.begin() + (f + 1) * count);
    one.names = {field};
    one.units = {set.units[std::size_t(f)]};
    return one;
  }
  throw Error(Fault::bad_argument,
              fmt::format("no field is named {}; there are {}", field, fmt::join(set.names, ", ")));
}

} // namespace cowgpu
