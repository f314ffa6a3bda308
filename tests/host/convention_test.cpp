#include "host/convention.hpp"

#include "host/error.hpp"
#include "host/spectrum/convert.hpp"
#include "host/spectrum/roundtrip.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>

using namespace cowgpu;

namespace {

const std::vector<Convention> all = [] {
  std::vector<Convention> list;
  for (const auto n :
       {Normalisation::orthonormal, Normalisation::four_pi, Normalisation::schmidt, Normalisation::unnormalised})
    for (const auto p : {Phase::condon_shortley, Phase::none}) list.push_back({n, p});
  return list;
}();

constexpr double pi = std::numbers::pi;
constexpr double ulp = std::numeric_limits<double>::epsilon();

// The one coefficient, complex and orthonormal, of a field that is a multiple of one harmonic.
struct Field {
  const char* name;
  int l, m;
  std::complex<double> a;
  double p; // the field is p P_lm(cos theta) times cos or sin of m phi, P_lm without phase
  bool sine;
};

// From Y_10 = sqrt(3/4pi) cos, Y_11 = -sqrt(3/8pi) sin e^{i phi}, Y_21 = -sqrt(15/8pi) sin cos e^{i phi},
// Y_22 = sqrt(15/32pi) sin^2 e^{2 i phi}; P_11 = sin, P_21 = 3 sin cos, P_22 = 3 sin^2.
const std::vector<Field> fields = {
    {"1", 0, 0, std::sqrt(4 * pi), 1, false},
    {"cos theta", 1, 0, std::sqrt(4 * pi / 3), 1, false},
    {"sin theta cos phi", 1, 1, -std::sqrt(2 * pi / 3), 1, false},
    {"sin theta sin phi", 1, 1, {0, std::sqrt(2 * pi / 3)}, 1, true},
    {"sin theta cos theta cos phi", 2, 1, -std::sqrt(2 * pi / 15), 1.0 / 3, false},
    {"sin^2 theta sin 2 phi", 2, 2, {0, -std::sqrt(8 * pi / 15)}, 1.0 / 3, true},
};

// Norm of P_lm cos m phi over the sphere, squared.
double norm_squared(int l, int m) {
  double quotient = 1;
  for (int k = l - m + 1; k <= l + m; ++k) quotient *= k;
  return (m == 0 ? 4 : 2) * pi / (2 * l + 1) * quotient;
}

// What the coefficient of p P_lm is by the definition of the convention: p over the factor K_lm.
double expected(const Field& f, Convention convention) {
  double target = 0;
  switch (convention.normalisation) {
  case Normalisation::orthonormal: target = 1; break;
  case Normalisation::four_pi: target = 4 * pi; break;
  case Normalisation::schmidt: target = 4 * pi / (2 * f.l + 1); break;
  case Normalisation::unnormalised: target = norm_squared(f.l, f.m); break;
  }
  const double sign = convention.phase == Phase::condon_shortley && f.m % 2 ? -1 : 1;
  return sign * f.p / std::sqrt(target / norm_squared(f.l, f.m));
}

bool refused(const auto& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.fault() == Fault::bad_argument;
  }
  return false;
}

} // namespace

TEST_CASE("simple fields have the coefficients each convention's definition gives them", "[convention]") {
  for (const Field& field : fields)
    for (const Convention convention : all) {
      INFO(field.name << ", " << name(convention.normalisation) << ", " << name(convention.phase));
      SphereCoefficients a(2, 1);
      a.at(0, field.l, field.m) = field.a;
      const CoefficientSet real = set_of(a, convention);
      const double want = expected(field, convention);
      for (int l = 0; l <= 2; ++l)
        for (int m = 0; m <= l; ++m) {
          const bool here = l == field.l && m == field.m;
          const std::size_t at = real.index(0, l, m);
          CHECK(std::fabs(real.first[at] - (here && !field.sine ? want : 0)) <= 8 * ulp * std::fabs(want));
          CHECK(std::fabs(real.second[at] - (here && field.sine ? want : 0)) <= 8 * ulp * std::fabs(want));
        }
    }
}

TEST_CASE("there and back is right to 4 units in the last place", "[convention]") {
  for (const Convention convention : all) {
    INFO(name(convention.normalisation) << ", " << name(convention.phase));
    const bool narrow = convention.normalisation == Normalisation::unnormalised;
    const SphereCoefficients a = random_coefficients(narrow ? 140 : 300, 2, 3);
    const SphereCoefficients b = orthonormal(set_of(a, convention));
    double worst = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i)
      for (const auto part :
           {+[](std::complex<double> z) { return z.real(); }, +[](std::complex<double> z) { return z.imag(); }}) {
        const double x = part(a.values[i]), y = part(b.values[i]);
        if (x != 0) worst = std::max(worst, std::fabs(y - x) / std::fabs(std::nextafter(x, 2 * x) - x));
        if (x == 0) CHECK(y == 0);
      }
    CHECK(worst <= 4);
    CHECK(b.fields == 2);
  }
}

TEST_CASE("degree 8192 fits all conventions but the unnormalised", "[convention]") {
  SphereCoefficients a(8192, 1);
  for (const int m : {0, 1, 4096, 8191, 8192}) a.at(0, 8192, m) = {0.25, m > 0 ? -0.5 : 0};
  for (const Convention convention : all) {
    if (convention.phase == Phase::condon_shortley) continue;
    INFO(name(convention.normalisation));
    if (convention.normalisation == Normalisation::unnormalised) {
      CHECK(refused([&] { set_of(a, convention); }));
      continue;
    }
    const SphereCoefficients b = orthonormal(set_of(a, convention));
    for (const int m : {0, 1, 4096, 8191, 8192})
      CHECK(std::abs(b.at(0, 8192, m) - a.at(0, 8192, m)) <= 2 * ulp * std::abs(a.at(0, 8192, m)));
  }
}

TEST_CASE("unnormalised coefficients are refused where a double cannot hold them, never infinite or lost",
          "[convention]") {
  const Convention unnormalised = {Normalisation::unnormalised, Phase::none};
  int first = -1;
  for (int l = 1; l < 400; ++l) {
    SphereCoefficients a(l, 1);
    a.at(0, l, l) = 1;
    const bool lost = refused([&] {
      const CoefficientSet real = set_of(a, unnormalised);
      CHECK(std::fabs(real.first.back()) >= std::numeric_limits<double>::min());
    });
    if (lost && first < 0) first = l;
    if (first >= 0) CHECK(lost);
  }
  CHECK(first == 151);
  // Zeros have a place at any degree, and so have zonal coefficients.
  SphereCoefficients zonal(2000, 1);
  zonal.at(0, 2000, 0) = 1;
  CHECK(std::isfinite(set_of(zonal, unnormalised).first[SphereCoefficients::index(2000, 2000, 0)]));
  // The other way: harmonics that overflow.
  CoefficientSet large(200, 1);
  large.convention = unnormalised;
  large.first.back() = 1;
  CHECK(refused([&] { orthonormal(large); }));
}

TEST_CASE("names of conventions read back, and pyshtools' are known", "[convention]") {
  for (const Convention convention : all) {
    CHECK(normalisation_named(name(convention.normalisation)) == convention.normalisation);
    CHECK(phase_named(name(convention.phase)) == convention.phase);
  }
  CHECK(normalisation_named("ortho") == Normalisation::orthonormal);
  CHECK(normalisation_named("unnorm") == Normalisation::unnormalised);
  CHECK(!normalisation_named("Ortho"));
  CHECK(!phase_named("1"));
}
