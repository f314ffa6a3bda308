#include "host/spectrum/rotation.hpp"

#include "host/error.hpp"
#include "host/mesh/placement.hpp"
#include "host/spectrum/quarter_turn.hpp"
#include "host/sphere_grid.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

namespace cowgpu {
namespace {

constexpr long double half_pi = std::numbers::pi_v<long double> / 2;

// An angle as quarters of a full turn and a rest.
struct Turn {
  int quarters = 0;
  long double rest = 0; // radians, |rest| <= pi / 4

  Turn(double angle) { // NOLINT: an angle is a turn
    const long double nearest = std::nearbyint(angle / half_pi);
    quarters = int(std::fmod(nearest, 4.0L));
    rest = angle == double(nearest * half_pi) ? 0 : angle - nearest * half_pi;
  }
  Turn(int quarters_, long double rest_) : quarters(quarters_), rest(rest_) {}
  Turn operator+(const Turn& other) const { return {quarters + other.quarters, rest + other.rest}; }
  Turn operator-() const { return {-quarters, -rest}; }
  int quarter() const { return (quarters % 4 + 4) % 4; }
};

// value * i^quarters
std::complex<double> turned(std::complex<double> value, long long quarters) {
  switch ((quarters % 4 + 4) % 4) {
  case 1: return {-value.imag(), value.real()};
  case 2: return -value;
  case 3: return {value.imag(), -value.real()};
  default: return value;
  }
}

std::complex<double> unit(const Turn& turn) {
  return turned({double(std::cos(turn.rest)), double(std::sin(turn.rest))}, turn.quarters);
}

// R_z: a_lm exp(-i m angle).
void turn_z(int lmax, std::span<std::complex<double>> a, const Turn& angle) {
  for (int m = 1; m <= lmax; ++m) {
    const std::complex<double> factor(double(std::cos(m * angle.rest)), -double(std::sin(m * angle.rest)));
    for (int l = m; l <= lmax; ++l) {
      std::complex<double>& value = a[SphereCoefficients::index(lmax, l, m)];
      value = turned(value, -(long long)m * angle.quarters);
      if (angle.rest != 0) value *= factor;
    }
  }
}

// R_y(pi): (-1)^l conj(a_lm).
void half_turn_y(int lmax, std::span<std::complex<double>> a) {
  for (int m = 0; m <= lmax; ++m)
    for (int l = m; l <= lmax; ++l) {
      std::complex<double>& value = a[SphereCoefficients::index(lmax, l, m)];
      value = l % 2 ? -std::conj(value) : std::conj(value);
    }
}

} // namespace

Eigen::Matrix3d rotation_matrix(const EulerAngles& angles) {
  const auto about = [](double angle, int from, int to) {
    const std::complex<double> u = unit(Turn(angle));
    Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
    r(from, from) = r(to, to) = u.real();
    r(to, from) = u.imag();
    r(from, to) = -u.imag();
    return r;
  };
  return about(angles.alpha, 0, 1) * about(angles.beta, 2, 0) * about(angles.gamma, 0, 1);
}

EulerAngles euler_angles(const Eigen::Matrix3d& r) {
  check_rotation(r, "the matrix");
  const double sine = std::hypot(r(0, 2), r(1, 2));
  EulerAngles angles;
  angles.beta = std::atan2(sine, r(2, 2));
  if (sine == 0) {
    angles.alpha = std::atan2(r(2, 2) > 0 ? r(1, 0) : -r(1, 0), r(1, 1));
  } else {
    angles.alpha = std::atan2(r(1, 2), r(0, 2));
    angles.gamma = std::atan2(r(2, 1), -r(2, 0));
  }
  return angles;
}

SphereCoefficients rotate(const SphereCoefficients& coefficients, const EulerAngles& angles, Monitor& monitor,
                          unsigned threads) {
  const int lmax = coefficients.lmax;
  if (lmax < 0 || lmax > largest_grid_degree)
    throw Error(Fault::bad_argument,
                fmt::format("coefficients to degree {} cannot be rotated: degrees 0 to {} are possible", lmax,
                            largest_grid_degree));
  for (const double angle : {angles.alpha, angles.beta, angles.gamma})
    if (!(std::fabs(angle) <= 1e6))
      throw Error(Fault::bad_argument,
                  fmt::format("a rotation by an angle of {} is out of range: radians up to 1e6 are possible", angle));

  const Turn alpha(angles.alpha), beta(angles.beta), gamma(angles.gamma);
  const Turn quarter(1, 0), half(2, 0);
  SphereCoefficients result = coefficients;
  const bool about_z = beta.rest == 0 && beta.quarter() % 2 == 0;
  std::optional<QuarterTurn> quarter_turn;
  if (!about_z) quarter_turn.emplace(lmax, threads);
  for (int f = 0; f < result.fields; ++f) {
    check_stop(monitor);
    const auto a = result.field(f);
    for (int l = 0; l <= lmax; ++l) a[std::size_t(l)] = a[std::size_t(l)].real();
    const double share = 1.0 / result.fields, done = f * share;
    if (about_z && beta.quarter() == 0) {
      turn_z(lmax, a, alpha + gamma);
    } else if (about_z) {
      turn_z(lmax, a, gamma);
      half_turn_y(lmax, a);
      turn_z(lmax, a, alpha);
    } else if (beta.rest == 0) {
      // R_y(-pi/2) = R_z(pi) R_y(pi/2) R_z(pi)
      const bool backwards = beta.quarter() == 3;
      turn_z(lmax, a, backwards ? gamma + half : gamma);
      quarter_turn->apply(a, monitor, done, share);
      turn_z(lmax, a, backwards ? alpha + half : alpha);
    } else {
      turn_z(lmax, a, gamma + quarter);
      quarter_turn->apply(a, monitor, done, share / 2);
      turn_z(lmax, a, beta + half);
      quarter_turn->apply(a, monitor, done + share / 2, share / 2);
      turn_z(lmax, a, alpha + quarter);
    }
  }
  monitor.progress("rotation", 1);
  return result;
}

} // namespace cowgpu
