// Reference of the stages `legendre_analysis`, `legendre_synthesis` and `ring_fourier`, and of the verbs made of them:
// plain sums in any number type, the oracle of both fast paths. Real needs about twice the digits of double only where
// the last digits of double are judged; long double does.
#pragma once

#include "host/sphere_coefficients.hpp"
#include "host/sphere_grid.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

namespace cowgpu::reference {

/// P_lm(cos theta), l = m ... lmax: orthonormal, Condon-Shortley phase, so that Y_lm = P_lm exp(i m phi). By
///   P_{l+1} = (x P_l - e_l P_{l-1}) / e_{l+1},  e_l = sqrt((l^2 - m^2) / (4 l^2 - 1)),
/// (Holmes and Featherstone, J. Geodesy 76 (2002) 279), with an exponent of its own, so that sin^m theta does not
/// underflow. `cosine` and `sine` are those of theta.
template <class Real>
std::vector<Real> legendre_column(Real cosine, Real sine, int m, int lmax) {
  using std::fabs, std::sqrt;
  const Real big = Real(0x1p200), small = Real(0x1p-200);
  std::vector<Real> p(std::size_t(lmax - m) + 1, Real(0));
  Real value = Real(1) / sqrt(Real(4) * Real(std::numbers::pi_v<long double>));
  int scale = 0; // the value is value * big^scale
  for (int q = 1; q <= m; ++q) {
    value *= -sine * sqrt(Real(2 * q + 1) / Real(2 * q));
    if (fabs(value) < small && value != Real(0)) {
      value *= big;
      --scale;
    }
  }
  const auto e = [m](int l) { return sqrt(Real(double(l - m) * double(l + m)) / Real((2.0 * l - 1) * (2.0 * l + 1))); };
  Real before = 0, factor = 0;
  for (int l = m; l <= lmax; ++l) {
    Real stored = value;
    for (int s = scale; s < 0 && stored != Real(0); ++s) stored = s < -6 ? Real(0) : stored * small;
    p[std::size_t(l - m)] = stored;
    const Real next_factor = e(l + 1), next = (cosine * value - factor * before) / next_factor;
    before = value;
    value = next;
    factor = next_factor;
    if (scale < 0 && fabs(value) > big) {
      value *= small;
      before *= small;
      ++scale;
    }
  }
  return p;
}

/// cos and sin of 2 pi j / n, j = 0 ... n-1.
template <class Real>
struct Circle {
  std::vector<Real> cosine, sine;
  explicit Circle(int n) : cosine(std::size_t(n)), sine(std::size_t(n)) {
    using std::cos, std::sin;
    for (int j = 0; j < n; ++j) {
      const Real angle = Real(2) * Real(std::numbers::pi_v<long double>) * Real(j) / Real(n);
      cosine[std::size_t(j)] = cos(angle);
      sine[std::size_t(j)] = sin(angle);
    }
  }
};

/// cos and sin of m phi_j of a grid's rings, for shifts 0 and 1/2.
template <class Real>
struct RingAngles {
  explicit RingAngles(const SphereGrid& grid)
      : halves(grid.shift == 0 ? 1 : 2), n(halves * std::size_t(grid.ring_length)), circle(int(n)) {}
  std::size_t halves, n;
  Circle<Real> circle;
  std::size_t first(int m) const { return halves == 1 ? 0 : std::size_t(m) % n; }
  std::size_t next(std::size_t at, int m) const { return (at + halves * std::size_t(m)) % n; }
};

/// Real and imaginary part.
template <class Real>
struct Pair {
  Real re{}, im{};
};

/// f(theta_i, phi_j) = sum a_lm Y_lm, times weight_i 2 pi / ring_length if `weighted`, for one field; [ring][longitude].
template <class Real>
std::vector<Real> synthesise(const SphereGrid& grid, int lmax, std::span<const Pair<Real>> coefficients,
                             bool weighted) {
  const RingAngles<Real> angles(grid);
  const Circle<Real>& circle = angles.circle;
  std::vector<Real> values(grid.points(), Real(0));
  const auto n = std::size_t(grid.ring_length);
  for (int i = 0; i < grid.rings; ++i) {
    const auto ring = std::size_t(i);
    const Real weight =
        weighted ? Real(grid.weights[ring]) * Real(2 * std::numbers::pi_v<long double>) / Real(grid.ring_length)
                 : Real(1);
    for (int m = 0; m <= lmax; ++m) {
      const auto p = legendre_column(Real(grid.cosine[ring]), Real(grid.sine[ring]), m, lmax);
      Pair<Real> sum;
      for (int l = m; l <= lmax; ++l) {
        const Pair<Real>& a = coefficients[SphereCoefficients::index(lmax, l, m)];
        sum.re += a.re * p[std::size_t(l - m)];
        sum.im += a.im * p[std::size_t(l - m)];
      }
      const Real factor = (m == 0 ? Real(1) : Real(2)) * weight;
      if (m == 0) sum.im = Real(0);
      for (std::size_t j = 0, at = angles.first(m); j < n; ++j, at = angles.next(at, m))
        values[ring * n + j] += factor * (sum.re * circle.cosine[at] - sum.im * circle.sine[at]);
    }
  }
  return values;
}

/// a_lm = sum over the points of f conj(Y_lm), with the quadrature weights if `weighted`, for one field.
template <class Real>
std::vector<Pair<Real>> analyse(const SphereGrid& grid, int lmax, std::span<const Real> values, bool weighted) {
  const RingAngles<Real> angles(grid);
  const Circle<Real>& circle = angles.circle;
  std::vector<Pair<Real>> coefficients(SphereCoefficients::count(lmax));
  const auto n = std::size_t(grid.ring_length);
  for (int i = 0; i < grid.rings; ++i) {
    const auto ring = std::size_t(i);
    const Real weight =
        weighted ? Real(grid.weights[ring]) * Real(2 * std::numbers::pi_v<long double>) / Real(grid.ring_length)
                 : Real(1);
    for (int m = 0; m <= lmax; ++m) {
      Pair<Real> sum;
      for (std::size_t j = 0, at = angles.first(m); j < n; ++j, at = angles.next(at, m)) {
        sum.re += values[ring * n + j] * circle.cosine[at];
        sum.im -= values[ring * n + j] * circle.sine[at];
      }
      const auto p = legendre_column(Real(grid.cosine[ring]), Real(grid.sine[ring]), m, lmax);
      for (int l = m; l <= lmax; ++l) {
        Pair<Real>& a = coefficients[SphereCoefficients::index(lmax, l, m)];
        a.re += weight * sum.re * p[std::size_t(l - m)];
        a.im += weight * sum.im * p[std::size_t(l - m)];
      }
    }
  }
  return coefficients;
}

} // namespace cowgpu::reference
