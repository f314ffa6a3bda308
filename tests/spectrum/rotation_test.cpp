// Rotation of coefficients against closed forms, an explicit sum in multiprecision, the field itself, and its laws.
#include "host/error.hpp"
#include "host/reference/sphere_transform.hpp"
#include "host/spectrum/rotation.hpp"
#include "host/spectrum/roundtrip.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/compare_transforms.hpp"
#include "tests/support/sphere_fields.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

SphereCoefficients turned(const SphereCoefficients& a, const EulerAngles& angles, unsigned threads = 0) {
  Monitor silent;
  return rotate(a, angles, silent, threads);
}

const std::vector<EulerAngles> some_angles = {
    {0.3, 1.1, -2.2},      {0, 0, 0},           {0.4, 0, 0.5},    {0.4, pi, 0.5},        {1.3, pi / 2, -0.1},
    {1.3, -pi / 2, -0.1},  {-2.5, 3.0, 6.0},    {0, 1e-9, 0},     {0.7, 1e-3, -0.7},     {0.2, pi - 1e-6, 3},
    {pi / 2, -1.4, pi},    {-pi / 2, 2.0, -pi}, {3.1, -2.9, 0.6}, {pi / 2, pi / 2, 0.0}, {12.0, 8.0, -9.0},
    {0, 1.5 * pi, pi / 2}, {2, -pi, 1},         {1, 2 * pi, 1}};

/// d^l_mn(beta).
using SmallD = std::function<double(int l, int m, int n, double beta)>;

/// Each real field of one coefficient, turned, against its column of D.
void check_against(int lmax, const std::vector<EulerAngles>& all, const SmallD& d, double figure) {
  double worst = 0;
  for (const EulerAngles& e : all)
    for (int l = 0; l <= lmax; ++l)
      for (int n = 0; n <= l; ++n) {
        SphereCoefficients a(l, 1);
        const Complex value = n == 0 ? Complex(0.8) : Complex(0.8, -0.6);
        a.at(0, l, n) = value;
        const SphereCoefficients b = turned(a, e);
        for (int m = 0; m <= l; ++m) {
          const auto term = [&](int from, Complex c) {
            return d(l, m, from, e.beta) * std::polar(1.0, -m * e.alpha - from * e.gamma) * c;
          };
          Complex expected = term(n, value);
          if (n > 0) expected += term(-n, (n % 2 ? -1.0 : 1.0) * std::conj(value));
          worst = std::max(worst, std::abs(b.at(0, l, m) - expected));
        }
      }
  check_at_most(worst, figure, fmt::format("degrees up to {}", lmax));
}

double small_d_closed_form(int l, int m, int n, double beta) {
  const double c = std::cos(beta), s = std::sin(beta);
  if (m < std::abs(n)) { // by symmetry to m >= |n|
    if (n > 0) return ((m - n) % 2 ? -1 : 1) * small_d_closed_form(l, n, m, beta);
    return small_d_closed_form(l, -n, -m, beta);
  }
  if (l == 0) return 1;
  if (l == 1) return m == 0 ? c : n == 1 ? (1 + c) / 2 : n == 0 ? -s / std::sqrt(2) : (1 - c) / 2;
  if (m == 0) return (3 * c * c - 1) / 2;
  if (m == 1) return n == 1 ? (1 + c) * (2 * c - 1) / 2 : n == 0 ? -std::sqrt(1.5) * s * c : (1 - c) * (2 * c + 1) / 2;
  switch (n) {
  case 2: return (1 + c) * (1 + c) / 4;
  case 1: return -(1 + c) * s / 2;
  case 0: return std::sqrt(6) / 4 * s * s;
  case -1: return -(1 - c) * s / 2;
  default: return (1 - c) * (1 - c) / 4;
  }
}

// Wigner's sum over k.
double small_d_explicit(int l, int m, int n, double beta) {
  using Real = boost::multiprecision::cpp_bin_float_50;
  static const std::vector<Real> factorial = [] {
    std::vector<Real> f{1};
    for (int i = 1; i <= 60; ++i) f.push_back(f.back() * i);
    return f;
  }();
  const auto fact = [](int i) { return factorial.at(std::size_t(i)); };
  const Real c = cos(Real(beta) / 2), s = sin(Real(beta) / 2);
  Real sum = 0;
  for (int k = std::max(0, n - m); k <= std::min(l + n, l - m); ++k) {
    const Real term = pow(c, 2 * l + n - m - 2 * k) * pow(s, m - n + 2 * k) /
                      (fact(l + n - k) * fact(k) * fact(m - n + k) * fact(l - m - k));
    sum += (m - n + k) % 2 ? Real(-term) : term;
  }
  return double(sum * sqrt(fact(l + m) * fact(l - m) * fact(l + n) * fact(l - n)));
}

bool equal(const SphereCoefficients& a, const SphereCoefficients& b) {
  return a.values == b.values;
}

/// Largest relative change of the norm of a degree.
double norm_change(const SphereCoefficients& a, const SphereCoefficients& b) {
  double worst = 0;
  for (int l = 0; l <= a.lmax; ++l) {
    double before = 0, after = 0;
    for (int m = 0; m <= l; ++m) {
      before += (m ? 2 : 1) * std::norm(a.at(0, l, m));
      after += (m ? 2 : 1) * std::norm(b.at(0, l, m));
    }
    worst = std::max(worst, std::fabs(std::sqrt(after / before) - 1));
  }
  return worst;
}

void check_unitary(int lmax, const EulerAngles& angles, double figure) {
  const SphereCoefficients a = random_coefficients(lmax, 1, 7), b = turned(a, angles);
  check_at_most(norm_change(a, b), figure, "norm of a degree");
  check_at_most(relative_error(turned(b, angles.inverse()).values, a.values), figure, "there and back");
}

} // namespace

TEST_CASE("rotations of degrees up to 2 are the closed forms of D", "[rotation]") {
  check_against(2, some_angles, small_d_closed_form, 1.5e-15);
}

TEST_CASE("rotations of degrees up to 20 are Wigner's sum in 50 digits", "[rotation]") {
  check_against(20, {some_angles[0], some_angles[4], some_angles[8], some_angles[9], some_angles[10]}, small_d_explicit,
                2e-14);
}

TEST_CASE("a rotated field at n is the field at R^-1 n", "[rotation]") {
  const SphereCoefficients a = random_coefficients(25, 2, 1);
  for (const EulerAngles& angles : some_angles) {
    const SphereCoefficients b = turned(a, angles);
    const Eigen::Matrix3d back = rotation_matrix(angles).transpose();
    double worst = 0;
    for (const Vec3& n : {Vec3(0.3, -0.5, 0.8), Vec3(0, 0, 1), Vec3(-1, 0.1, -0.2), Vec3(0, 1, 0)})
      for (int f = 0; f < 2; ++f)
        worst = std::max(worst, std::fabs(double(field_at(b, f, direction(n)).value -
                                                 field_at(a, f, direction(Vec3(back * n))).value)) /
                                    field_scale(a, f));
    check_at_most(worst, 8e-15, fmt::format("angles {} {} {}", angles.alpha, angles.beta, angles.gamma));
  }
}

TEST_CASE("a rotated zonal field is the addition theorem, to degree 1024", "[rotation]") {
  const int lmax = 1024;
  SphereCoefficients a(lmax, 1);
  for (int l = 0; l <= lmax; ++l) a.at(0, l, 0) = 1;
  for (const double beta : {0.9, 1e-3, pi / 2, 3.1}) {
    const SphereCoefficients b = turned(a, {0.4, beta, 5.0});
    double worst = 0;
    for (int m = 0; m <= lmax; ++m) {
      const auto p =
          reference::legendre_column<long double>(std::cos((long double)beta), std::sin((long double)beta), m, lmax);
      const long double angle = -m * (long double)(0.4);
      for (int l = m; l <= lmax; ++l) {
        const long double d = std::sqrt(4 * std::numbers::pi_v<long double> / (2 * l + 1)) * p[std::size_t(l - m)];
        const Complex expected(double(d * std::cos(angle)), double(d * std::sin(angle)));
        worst = std::max(worst, std::abs(b.at(0, l, m) - expected));
      }
    }
    check_at_most(worst, 4e-14, fmt::format("beta {}", beta));
  }
}

TEST_CASE("a rotated sectoral field is a binomial distribution, to degree 1500", "[rotation]") {
  // d^l_ml = sqrt(binomial(2l, l + m)) cos^(l+m) sin^(l-m) of beta/2; at 1500 start values lie below doubles.
  const int lmax = 1500;
  SphereCoefficients a(lmax, 1);
  for (int l = 0; l <= lmax; ++l) a.at(0, l, l) = 1;
  const double beta = 1.9;
  const SphereCoefficients b = turned(a, {0, beta, 0});
  const long double c = std::log(std::cos(beta / 2.0L)), s = std::log(std::sin(beta / 2.0L));
  double worst = 0;
  for (int l = 1; l <= lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      const long double root = (std::lgamma(2 * l + 1.0L) - std::lgamma(l + m + 1.0L) - std::lgamma(l - m + 1.0L)) / 2;
      const long double plus = std::exp(root + (l + m) * c + (l - m) * s);
      const long double minus = std::exp(root + (l - m) * c + (l + m) * s) * ((l + m) % 2 ? -1 : 1); // d^l_m,-l
      worst = std::max(worst, std::abs(b.at(0, l, m) - Complex(double(plus + (l % 2 ? -minus : minus)))));
    }
  check_at_most(worst, 1.5e-15, "coefficients");
}

TEST_CASE("rotations keep the norm of each degree and can be undone", "[rotation]") {
  for (const EulerAngles& angles : some_angles) check_unitary(100, angles, 1.4e-14);
}

TEST_CASE("rotations are unitary at degree 1024", "[rotation][long]") {
  for (const double beta : {0.9, 1e-3, 2.5, pi / 2}) check_unitary(1024, {0.3, beta, -2.2}, 4e-14);
}

TEST_CASE("rotations are unitary at degree 2048", "[rotation][long]") {
  check_unitary(2048, {2.3, 1.2, 0.2}, 4e-14);
}

TEST_CASE("two rotations are one by the product of the matrices", "[rotation]") {
  const SphereCoefficients a = random_coefficients(60, 1, 3);
  for (std::size_t i = 0; i + 1 < some_angles.size(); ++i) {
    const EulerAngles &first = some_angles[i], &second = some_angles[i + 1];
    const SphereCoefficients b = turned(turned(a, first), second);
    const SphereCoefficients c = turned(a, euler_angles(rotation_matrix(second) * rotation_matrix(first)));
    check_at_most(relative_error(c.values, b.values), 1e-13, fmt::format("rotations {} and {}", i, i + 1));
  }
}

TEST_CASE("Euler angles and matrices name the same rotation", "[rotation]") {
  for (const EulerAngles& angles : some_angles) {
    const Eigen::Matrix3d r = rotation_matrix(angles);
    CHECK((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-15);
    CHECK((rotation_matrix(euler_angles(r)) - r).norm() < 2e-15);
    CHECK((rotation_matrix(angles.inverse()) - r.transpose()).norm() < 1e-15);
  }
  // The x axis goes to y, z to x, and both in turn.
  CHECK(rotation_matrix({pi / 2, 0, 0}) * Vec3::UnitX() == Vec3::UnitY());
  CHECK(rotation_matrix({0, pi / 2, 0}) * Vec3::UnitZ() == Vec3::UnitX());
  CHECK(rotation_matrix({pi / 2, pi / 2, 0}) * Vec3::UnitZ() == Vec3::UnitY());
  for (const EulerAngles angles : {EulerAngles{pi / 2, 0, 0}, {pi / 2, pi / 2, 0}, {0, pi, 0}, {-pi / 2, pi, 0}})
    CHECK(rotation_matrix(euler_angles(rotation_matrix(angles))) == rotation_matrix(angles));
}

TEST_CASE("turns about z by 90 degrees and half turns only move and negate numbers", "[rotation]") {
  const int lmax = 50;
  const SphereCoefficients a = random_coefficients(lmax, 2, 5);
  CHECK(equal(turned(a, {0, 0, 0}), a));
  CHECK(equal(turned(a, {2 * pi, 0, -4 * pi}), a));
  for (int quarters = -5; quarters <= 5; ++quarters) {
    SphereCoefficients expected = a;
    for (int f = 0; f < 2; ++f)
      for (int m = 0; m <= lmax; ++m)
        for (int l = m; l <= lmax; ++l)
          for (int i = 0; i < (m * (quarters + 8)) % 4; ++i) { // times -i
            const Complex value = expected.at(f, l, m);
            expected.at(f, l, m) = {value.imag(), -value.real()};
          }
    CHECK(equal(turned(a, {quarters * (pi / 2), 0, 0}), expected));
    CHECK(equal(turned(a, {0, 0, quarters * (pi / 2)}), expected));
  }
  SphereCoefficients flipped = a;
  for (int f = 0; f < 2; ++f)
    for (int m = 0; m <= lmax; ++m)
      for (int l = m; l <= lmax; ++l) flipped.at(f, l, m) = (l % 2 ? -1.0 : 1.0) * std::conj(a.at(f, l, m));
  CHECK(equal(turned(a, {0, pi, 0}), flipped));
  CHECK(equal(turned(a, {0, -pi, 0}), flipped));
  // About x: y goes to -y by a half turn, the third axis by two.
  CHECK(equal(turned(turned(a, {0, pi, 0}), {pi, 0, 0}), turned(a, {pi, pi, 0})));
  SphereCoefficients around = a;
  for (int i = 0; i < 4; ++i) around = turned(around, {0, pi / 2, 0});
  check_at_most(relative_error(around.values, a.values), 4e-15, "four quarter turns about y");
}

TEST_CASE("rotations are the same bits for any number of threads", "[rotation]") {
  const SphereCoefficients a = random_coefficients(133, 2, 9);
  const SphereCoefficients b = turned(a, {1, 2, 3}, 1);
  for (const unsigned threads : {2U, 3U, 7U, 0U}) CHECK(equal(turned(a, {1, 2, 3}, threads), b));
}

TEST_CASE("imaginary parts at m = 0 do not count in a rotation", "[rotation]") {
  SphereCoefficients a = random_coefficients(20, 1, 2), b = a;
  for (int l = 0; l <= 20; ++l) b.at(0, l, 0) += Complex(0, 3);
  for (const double beta : {0.0, 0.5, pi / 2, pi}) CHECK(equal(turned(a, {1, beta, 3}), turned(b, {1, beta, 3})));
}

TEST_CASE("a rotation tells its progress, stops when asked and refuses what is none", "[rotation]") {
  struct Watch : Monitor {
    void progress(const char* what, double fraction) override {
      CHECK(std::string(what) == "rotation");
      rising = rising && fraction >= last && fraction <= 1;
      last = fraction;
      if (++calls == stop_after) stop = true;
    }
    bool stopped() const override { return stop; }
    double last = 0;
    bool rising = true;
    int calls = 0, stop_after = 0;
    std::atomic<bool> stop = false;
  };
  const SphereCoefficients a = random_coefficients(90, 2, 4);
  Watch watch;
  rotate(a, {1, 2, 3}, watch);
  CHECK(watch.rising);
  CHECK(watch.last == 1);
  CHECK(watch.calls > 10);

  const auto fault_of = [](const auto& call) {
    try {
      call();
    } catch (const Error& error) {
      return name(error.fault());
    }
    return std::string_view("none");
  };
  Watch stopping;
  stopping.stop_after = 3;
  CHECK(fault_of([&] { rotate(a, {1, 2, 3}, stopping); }) == name(Fault::interrupted));
  CHECK(stopping.calls <= 4);

  Monitor silent;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(fault_of([&] { rotate(a, {1, nan, 3}, silent); }) == name(Fault::bad_argument));
  CHECK(fault_of([&] { rotate(a, {1, 2, 1e300}, silent); }) == name(Fault::bad_argument));
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
  mirror(2, 2) = -1;
  CHECK(fault_of([&] { euler_angles(mirror); }) == name(Fault::bad_argument));
  CHECK(fault_of([&] { euler_angles(2 * Eigen::Matrix3d::Identity()); }) == name(Fault::bad_argument));
  CHECK(fault_of([&] { euler_angles(nan * Eigen::Matrix3d::Identity()); }) == name(Fault::bad_argument));
}
