#include "host/spectrum/convert.hpp"

#include "host/backend.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/spectrum/difference.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

Monitor silent;

constexpr Normalisation normalisations[] = {Normalisation::orthonormal, Normalisation::four_pi, Normalisation::schmidt,
                                            Normalisation::unnormalised};

// Doubles between both, of one sign.
std::int64_t steps(double a, double b) {
  if (a == b) return 0;
  if (std::signbit(a) != std::signbit(b)) return std::int64_t(1) << 60;
  return std::abs(std::bit_cast<std::int64_t>(a) - std::bit_cast<std::int64_t>(b));
}

std::int64_t largest_step(const CoefficientSet& a, const CoefficientSet& b) {
  std::int64_t largest = 0;
  for (std::size_t i = 0; i < a.first.size(); ++i)
    largest = std::max({largest, steps(a.first[i], b.first[i]), steps(a.second[i], b.second[i])});
  return largest;
}

CoefficientSet random_set(int lmax, CoefficientKind kind, Form form, Convention convention) {
  CoefficientSet set = set_of(random_coefficients(lmax, 1, 17), {});
  if (convention.normalisation == Normalisation::unnormalised) // of their own size, which is not 1
    set = converted(set, {.normalisation = Normalisation::unnormalised});
  set.form = form;
  set.convention = convention;
  set.kind = kind;
  if (kind == CoefficientKind::field) return set;
  set.reference_radius = 0.7;
  set.mass = 3.0 / 7;
  set.gravitational_constant = 1;
  if (kind == CoefficientKind::potential) set.gm = set.mass;
  return set;
}

ConversionTarget back_to(const CoefficientSet& set) {
  ConversionTarget target;
  target.form = set.form;
  target.normalisation = set.convention.normalisation;
  target.phase = set.convention.phase;
  if (set.kind != CoefficientKind::field) target.kind = set.kind;
  target.reference_radius = set.reference_radius;
  return target;
}

void there_and_back(int lmax, bool unnormalised) {
  std::int64_t largest = 0;
  for (const auto kind : {CoefficientKind::field, CoefficientKind::multipoles, CoefficientKind::potential})
    for (const Form form : {Form::real, Form::complex})
      for (const Normalisation from : normalisations)
        for (const Normalisation to : normalisations)
          for (const bool other_kind : {false, true}) {
            if (!unnormalised && (from == Normalisation::unnormalised || to == Normalisation::unnormalised)) continue;
            if (lmax > 200 && (form == Form::real || !other_kind)) continue; // the same factors, at length
            const CoefficientSet set = random_set(lmax, kind, form, {from, Phase::none});
            ConversionTarget target;
            target.form = form == Form::real ? Form::complex : Form::real;
            target.normalisation = to;
            target.phase = Phase::condon_shortley;
            if (kind != CoefficientKind::field) target.reference_radius = 0.6;
            if (kind != CoefficientKind::field && other_kind)
              target.kind =
                  kind == CoefficientKind::potential ? CoefficientKind::multipoles : CoefficientKind::potential;
            const CoefficientSet back = converted(converted(set, target), back_to(set));
            CHECK(back.convention == set.convention);
            CHECK(back.kind == set.kind);
            largest = std::max(largest, largest_step(set, back));
          }
  INFO("largest distance in doubles to degree " << lmax << ": " << largest);
  CHECK(largest <= 2);
}

} // namespace

TEST_CASE("conversions there and back are right to two units in the last place", "[convert]") {
  there_and_back(140, true);
  there_and_back(200, false);
  there_and_back(1024, false);
}

TEST_CASE("between unnormalised coefficients only signs and factors of two change, to any degree", "[convert]") {
  CoefficientSet set = random_set(300, CoefficientKind::field, Form::real, {});
  set.convention = {Normalisation::unnormalised, Phase::none};
  const CoefficientSet turned = converted(set, {.form = Form::complex, .phase = Phase::condon_shortley});
  CHECK(turned.first[set.index(0, 299, 3)] == -0.5 * set.first[set.index(0, 299, 3)]);
  CHECK(turned.second[set.index(0, 299, 3)] == 0.5 * set.second[set.index(0, 299, 3)]);
  CHECK(largest_step(converted(turned, back_to(set)), set) == 0);
}

TEST_CASE("what nothing is asked of keeps its bits", "[convert]") {
  const CoefficientSet set = random_set(64, CoefficientKind::multipoles, Form::complex, {});
  const CoefficientSet same = converted(set, back_to(set));
  CHECK(same.first == set.first);
  CHECK(same.second == set.second);
  const SphereCoefficients q = orthonormal(set);
  CHECK(q.at(0, 9, 4) == std::complex(set.first[set.index(0, 9, 4)], set.second[set.index(0, 9, 4)]));
}

TEST_CASE("coefficients without a place among doubles are named, with what to do", "[convert]") {
  const CoefficientSet set = random_set(200, CoefficientKind::potential, Form::real, {});
  CHECK_THAT(fault_of([&] { converted(set, {.normalisation = Normalisation::unnormalised}); }),
             StartsWith("bad-argument: ") && Contains("--lmax") && Contains("another normalisation"));
  CHECK_THAT(fault_of([&] { converted(set, {.reference_radius = 1e5}); }),
             StartsWith("bad-argument: ") && Contains("reference radius"));
  CHECK_THAT(fault_of([&] { converted(set, {.reference_radius = 1e-5}); }), StartsWith("bad-argument: "));
  CHECK_THAT(fault_of([&] { converted(set, {.reference_radius = -1}); }), Contains("above 0"));
  CHECK_THAT(fault_of([&] { converted(set, {.lmax = 201}); }), StartsWith("bad-argument: "));
  const CoefficientSet field = random_set(3, CoefficientKind::field, Form::real, {});
  CHECK_THAT(fault_of([&] { converted(field, {.reference_radius = 1}); }), Contains("no reference radius"));
  CHECK_THAT(fault_of([&] { converted(field, {.kind = CoefficientKind::potential}); }), Contains("another thing"));
  CoefficientSet empty = random_set(3, CoefficientKind::multipoles, Form::complex, {});
  empty.mass = 0;
  CHECK_THAT(fault_of([&] { converted(empty, {.kind = CoefficientKind::potential}); }), Contains("mass is 0"));
  CoefficientSet foreign = random_set(3, CoefficientKind::potential, Form::real, {});
  foreign.mass.reset();
  foreign.gravitational_constant.reset();
  CHECK_THAT(fault_of([&] { converted(foreign, {.kind = CoefficientKind::multipoles}); }), Contains("--si"));
}

TEST_CASE("multipoles become the coefficients of geodesy by the relation in the books", "[convert]") {
  // A point mass M at (x, y, z): C_lm + i S_lm = (r/R)^l P_lm(cos theta) exp(i m phi) / (2l + 1), fully normalised.
  const double x = 0.3, y = -0.4, z = 0.5, mass = 2.5, radius = 1.25;
  const double r2 = x * x + y * y + z * z;
  CoefficientSet q(2, 1);
  q.kind = CoefficientKind::multipoles;
  q.form = Form::complex;
  q.reference_radius = radius;
  const auto set = [&](int l, int m, double re, double im) { // M r^l Y_lm / R^l
    q.first[q.index(0, l, m)] = mass * re / std::pow(radius, l);
    q.second[q.index(0, l, m)] = mass * im / std::pow(radius, l);
  };
  const double pi = std::numbers::pi;
  set(0, 0, std::sqrt(1 / (4 * pi)), 0);
  set(1, 0, std::sqrt(3 / (4 * pi)) * z, 0);
  set(1, 1, -std::sqrt(3 / (8 * pi)) * x, -std::sqrt(3 / (8 * pi)) * y);
  set(2, 0, std::sqrt(5 / (16 * pi)) * (3 * z * z - r2), 0);
  set(2, 1, -std::sqrt(15 / (8 * pi)) * z * x, -std::sqrt(15 / (8 * pi)) * z * y);
  set(2, 2, std::sqrt(15 / (32 * pi)) * (x * x - y * y), std::sqrt(15 / (32 * pi)) * 2 * x * y);
  ConversionTarget target;
  target.kind = CoefficientKind::potential;
  target.form = Form::real;
  target.normalisation = Normalisation::four_pi;
  target.phase = Phase::none;
  const CoefficientSet c = converted(q, target);
  CHECK(*c.mass == Approx(mass).epsilon(1e-15));
  CHECK(*c.gm == *c.mass);
  const auto check = [&](int l, int m, double cosine, double sine) {
    CHECK(c.first[c.index(0, l, m)] == Approx(cosine / std::pow(radius, l)).epsilon(1e-14));
    CHECK(c.second[c.index(0, l, m)] == Approx(sine / std::pow(radius, l)).epsilon(1e-14));
  };
  check(0, 0, 1, 0);
  check(1, 0, z / std::sqrt(3), 0);
  check(1, 1, x / std::sqrt(3), y / std::sqrt(3));
  check(2, 0, (3 * z * z - r2) / (2 * std::sqrt(5)), 0);
  check(2, 1, std::sqrt(15) / 5 * z * x, std::sqrt(15) / 5 * z * y);
  check(2, 2, std::sqrt(15) / 10 * (x * x - y * y), std::sqrt(15) / 5 * x * y);
  q.length_unit = "m";
  q.mass_unit = "kg";
  CHECK(*converted(q, target).gm == Approx(mass * 6.6743e-11).epsilon(1e-15));
}

TEST_CASE("multipoles turned are those of the turned body, of every kind and form", "[convert]") {
  const EulerAngles angles{0.4, 1.1, -2.3};
  const RawMesh mesh = load_mesh("builtin:cow@1");
  const auto moments = [&](RawMesh raw) {
    const Body body = make_body(ClosedSurface::from(std::move(raw)), {}, 1);
    return make_cpu_backend()->moments(mass_problems(body, 20, default_cut_off).front())->run(silent);
  };
  const auto as_set = [](const Multipoles& q) {
    CoefficientSet set(q.lmax, 1);
    set.kind = CoefficientKind::multipoles;
    set.form = Form::complex;
    set.reference_radius = q.reference_radius;
    for (int l = 0; l <= q.lmax; ++l)
      for (int m = 0; m <= l; ++m) {
        set.first[set.index(0, l, m)] = q(l, m).real();
        set.second[set.index(0, l, m)] = q(l, m).imag();
      }
    return set;
  };
  const CoefficientSet still = as_set(moments(mesh)), moved = as_set(moments(rotated(mesh, rotation_matrix(angles))));
  for (const auto kind : {CoefficientKind::multipoles, CoefficientKind::potential})
    for (const Form form : {Form::real, Form::complex}) {
      ConversionTarget target;
      target.kind = kind;
      target.form = form;
      target.phase = form == Form::real ? Phase::none : Phase::condon_shortley;
      const CoefficientSet turned = rotated(converted(still, target), angles, silent);
      CHECK(turned.kind == kind);
      CHECK(difference(moved, turned, {}).worst() <= 1e-13);
    }
}

TEST_CASE("turned there and back a coefficient returns to four units in the last place of its degree's norm",
          "[convert]") {
  for (const int lmax : {60, 200, 1024}) {
    const CoefficientSet set = random_set(lmax, CoefficientKind::multipoles, Form::complex, {});
    const EulerAngles angles{1, 0.3, -0.7};
    const CoefficientSet back = rotated(rotated(set, angles, silent), angles.inverse(), silent);
    double worst = 0;
    for (int l = 0; l <= lmax; ++l) {
      double norm = 0, largest = 0;
      for (int m = 0; m <= l; ++m) {
        const std::size_t i = set.index(0, l, m);
        norm += (m ? 2 : 1) * (set.first[i] * set.first[i] + set.second[i] * set.second[i]);
        largest =
            std::max({largest, std::fabs(back.first[i] - set.first[i]), std::fabs(back.second[i] - set.second[i])});
      }
      worst = std::max(worst, largest / std::sqrt(norm));
    }
    INFO("to degree " << lmax << ": " << worst / 0x1p-52 << " units");
    CHECK(worst <= 4 * 0x1p-52);
  }
}

TEST_CASE("a difference is told degree by degree, whatever the conventions", "[convert][diff]") {
  const CoefficientSet a = random_set(30, CoefficientKind::multipoles, Form::complex, {});
  ConversionTarget target;
  target.kind = CoefficientKind::potential;
  target.form = Form::real;
  target.normalisation = Normalisation::schmidt;
  target.phase = Phase::none;
  target.reference_radius = 0.8;
  CoefficientSet b = converted(a, target);
  CHECK(difference(a, b, {}).worst() <= 1e-15);
  CHECK(difference(b, a, {}).worst() <= 1e-15);
  b.first[b.index(0, 7, 3)] *= 1 + 1e-6;
  const CoefficientDifference found = difference(a, b, {Normalisation::four_pi, Phase::none});
  REQUIRE(found.fields.size() == 1);
  CHECK(found.fields[0].worst_degree == 7);
  CHECK(found.fields[0].worst_order[7] == 3);
  CHECK(found.fields[0].relative(7) <= 1e-6);
  CHECK(found.fields[0].relative(7) >= 1e-8);
  CHECK(found.fields[0].relative(8) <= 1e-15);
  CHECK(found.unlike.size() >= 5);
  // Norms in the orthonormal convention are those of all orders, negative ones included.
  const CoefficientDifference plain = difference(a, a, {});
  double norm = 0;
  for (int m = 0; m <= 5; ++m)
    norm += (m ? 2 : 1) * (std::pow(a.first[a.index(0, 5, m)], 2) + std::pow(a.second[a.index(0, 5, m)], 2));
  CHECK(plain.fields[0].norm[5] == Approx(std::sqrt(norm)).epsilon(1e-14));
  CHECK(plain.worst() == 0);
  CHECK(plain.unlike.empty());
}

TEST_CASE("sets about other points, of other kinds or fields are not compared", "[convert][diff]") {
  CoefficientSet a = random_set(3, CoefficientKind::multipoles, Form::complex, {}), b = a;
  a.origin = Vec3(1, 2, 3);
  b.origin = Vec3(1, 2, 3.000001);
  CHECK_THAT(fault_of([&] { difference(a, b, {}); }), StartsWith("bad-argument: ") && Contains("translation"));
  b.origin = Vec3(1, 2, 3 + 1e-15);
  CHECK(fault_of([&] { difference(a, b, {}); }) == "none");
  const CoefficientSet field = random_set(3, CoefficientKind::field, Form::complex, {});
  CHECK_THAT(fault_of([&] { difference(a, field, {}); }), StartsWith("bad-argument: "));
  CHECK_THAT(fault_of([&] { difference(a, CoefficientSet(3, 2), {}); }), Contains("2 in the second"));
}
