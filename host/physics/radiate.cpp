#include "host/physics/radiate.hpp"

#include "host/coefficient_set.hpp"
#include "host/error.hpp"
#include "host/number.hpp"
#include "host/spectrum/rotation.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

namespace cowgpu::physics {
namespace {

using Real = long double;
using Vec = Eigen::Matrix<Real, 3, 1>;
using Mat = Eigen::Matrix<Real, 3, 3>;
using Third = std::array<Mat, 3>;

constexpr Real c = speed_of_light_si;
constexpr Real c5 = c * c * c * c * c;

Vec unit_vector(const Vec3& axis) {
  const Real norm = axis.cast<Real>().norm();
  if (!(norm > 0) || !std::isfinite(norm))
    throw Error(Fault::bad_argument,
                fmt::format("the axis ({}, {}, {}) is not a direction: it must have a finite length above 0", axis.x(),
                            axis.y(), axis.z()));
  return axis.cast<Real>() / norm;
}

// w x = axis cross x, the generator of the rotation.
Mat generator(const Vec3& axis) {
  const Vec a = unit_vector(axis);
  Mat w;
  w << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return w;
}

Third extended(const Tensor3& t) {
  return {t[0].cast<Real>(), t[1].cast<Real>(), t[2].cast<Real>()};
}

// C_ikk.
Vec trace(const Third& t) {
  return {t[0].trace(), t[1].trace(), t[2].trace()};
}

// The time derivative of a turning tensor over omega: w acts on each index.
Third turned(const Third& t, const Mat& w) {
  Third result;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Mat& own = t[std::size_t(i)];
    result[std::size_t(i)] = w * own - own * w; // w is antisymmetric
    for (Eigen::Index a = 0; a < 3; ++a) result[std::size_t(i)] += w(i, a) * t[std::size_t(a)];
  }
  return result;
}

// "1.25e-03" as "0.00125".
std::string without_exponent(const std::string& text) {
  const std::size_t e = text.find('e');
  const int exponent = read_whole(text.substr(e + 1), -5000, 5000).value(); // decimal exponent of a long double
  std::string digits = text.substr(0, e);
  digits.erase(std::remove(digits.begin(), digits.end(), '.'), digits.end());
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.empty()) return "0";
  if (exponent < 0) return "0." + std::string(std::size_t(-exponent - 1), '0') + digits;
  const std::size_t whole = std::size_t(exponent) + 1;
  if (digits.size() <= whole) return digits + std::string(whole - digits.size(), '0');
  return digits.substr(0, whole) + "." + digits.substr(whole);
}

void check_finite_positive(const char* what, double value, bool zero_too) {
  if (std::isfinite(value) && (value > 0 || (zero_too && value == 0))) return;
  throw Error(Fault::bad_argument, fmt::format("the {} is {}; it must be finite and {}", what, value,
                                               zero_too ? "not negative" : "above 0"));
}

} // namespace

double quadrupole_square(const Eigen::Matrix3d& quadrupole, const Vec3& axis) {
  const Vec a = unit_vector(axis);
  const Mat q = quadrupole.cast<Real>();
  const Mat p = Mat::Identity() - a * a.transpose();
  const Mat across = p * q * p;
  const Mat t = across - across.trace() / 2 * p;
  const Vec v = p * q * a;
  return double(64 * t.squaredNorm() + 2 * v.squaredNorm());
}

double quadrupole_square(const std::array<std::complex<double>, 3>& q, const Vec3& axis) {
  const Vec a = unit_vector(axis);
  SphereCoefficients field(2, 1); // rotate() turns fields, whose coefficients are the conjugates
  for (int m = 0; m <= 2; ++m) field.at(0, 2, m) = std::conj(q[std::size_t(m)]);
  const auto theta = double(std::atan2(std::hypot(a[0], a[1]), a[2])), phi = double(std::atan2(a[1], a[0]));
  Monitor monitor;
  field = rotate(field, {0, -theta, -phi}, monitor, 1);
  const double sum = 2 * (std::norm(field.at(0, 2, 1)) + 64 * std::norm(field.at(0, 2, 2)));
  return 24 * std::numbers::pi / 5 * sum;
}

double octupole_square(const Tensor3& third_moment, const Vec3& axis) {
  const Mat w = generator(axis);
  Third t = extended(third_moment);
  const Vec s = trace(t) / 5;
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 3; ++j) {
      t[std::size_t(i)](j, j) -= s[i];
      t[std::size_t(i)](i, j) -= s[j];
      t[std::size_t(i)](j, i) -= s[j];
    }
  for (int n = 0; n < 4; ++n) t = turned(t, w);
  return double(t[0].squaredNorm() + t[1].squaredNorm() + t[2].squaredNorm());
}

double current_quadrupole_square(const Tensor3& third_moment, const Vec3& axis) {
  const Vec a = unit_vector(axis);
  const Mat w = generator(axis);
  const Third t = extended(third_moment);
  // x cross (a cross x) = a r^2 - x (a.x); the trace vanishes as it is.
  const Vec s = trace(t);
  Mat j = (s * a.transpose() + a * s.transpose()) / 2;
  for (std::size_t k = 0; k < 3; ++k) j -= a[Eigen::Index(k)] * t[k];
  for (int n = 0; n < 3; ++n) j = Mat(w * j - j * w);
  return double(j.squaredNorm());
}

long double quadrupole_power(double square, double omega) {
  return Real(gravitational_constant_si) / (45 * c5) * square * std::pow(Real(omega), 6);
}

long double octupole_power(double square, double omega) {
  return Real(gravitational_constant_si) / (189 * c5 * c * c) * square * std::pow(Real(omega), 8);
}

long double current_quadrupole_power(double square, double omega) {
  return 16 * Real(gravitational_constant_si) / (45 * c5 * c * c) * square * std::pow(Real(omega), 8);
}

std::string plain_decimal(long double value, int significant) {
  return without_exponent(fmt::format("{:.{}e}", value, significant - 1));
}

std::string plain_decimal(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific).ptr;
  return without_exponent({text.data(), end});
}

std::string decimal_difference(const std::string& a, const std::string& b) {
  const auto places = [](const std::string& t) {
    return t.find('.') == std::string::npos ? 0 : t.size() - t.find('.') - 1;
  };
  const std::size_t fraction = std::max(places(a), places(b));
  const auto digits = [&](std::string t) { // as a whole number of 10^-fraction
    t += std::string(fraction - places(t), '0');
    t.erase(std::remove(t.begin(), t.end(), '.'), t.end());
    return t;
  };
  std::string first = digits(a), second = digits(b);
  const std::size_t length = std::max({first.size(), second.size(), fraction + 1});
  first.insert(0, length - first.size(), '0');
  second.insert(0, length - second.size(), '0');
  int borrow = 0;
  for (std::size_t i = length; i-- > 0;) {
    int digit = first[i] - second[i] - borrow;
    borrow = digit < 0 ? 1 : 0;
    first[i] = char('0' + digit + 10 * borrow);
  }
  if (borrow)
    throw Error(Fault::bad_argument,
                fmt::format("{} - {} is below 0, and only differences of 0 or more are computed", a, b));
  std::string whole = first.substr(0, length - fraction), rest = first.substr(length - fraction);
  whole.erase(0, std::min(whole.find_first_not_of('0'), whole.size() - 1));
  rest.erase(rest.find_last_not_of('0') + 1);
  return rest.empty() ? whole : whole + "." + rest;
}

SpinDown spin_down(double moment_of_inertia, long double power, double omega, double time) {
  check_finite_positive("moment of inertia about the axis", moment_of_inertia, false);
  check_finite_positive("angular frequency", omega, false);
  check_finite_positive("time since the start", time, true);
  SpinDown result;
  result.energy = Real(moment_of_inertia) * omega * omega / 2;
  result.timescale = power > 0 ? result.energy / power : std::numeric_limits<Real>::infinity();
  result.deficit = -std::expm1(-std::log1p(2 * time / result.timescale) / 4);
  constexpr int digits = 15;
  result.omega = result.deficit > 0.5L
                     ? plain_decimal(omega * std::exp(-std::log1p(2 * time / result.timescale) / 4), digits)
                     : decimal_difference(plain_decimal(omega), plain_decimal(omega * result.deficit, digits));
  return result;
}

} // namespace cowgpu::physics
