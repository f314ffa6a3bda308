#include "host/mass/translate.hpp"

#include "host/mesh/geometry.hpp"
#include "host/parallel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace cowgpu {
namespace {

using Real = long double;
using Complex = std::complex<Real>;

constexpr int largest_degree_moved = 800;
constexpr double least_distance = 16; // radii
constexpr double least_term = 0x1p-64;

/// From the far origin to the near one, over R.
std::array<Real, 3> shift(const MomentProblem& far, const MomentProblem& near) {
  std::array<Real, 3> d{};
  for (std::size_t c = 0; c < 3; ++c)
    d[c] = (Real(near.origin[Eigen::Index(c)]) - Real(far.origin[Eigen::Index(c)])) / Real(far.reference_radius);
  return d;
}

Real length(const std::array<Real, 3>& d) {
  return std::hypot(d[0], d[1], d[2]);
}

std::vector<Real> factorials(int n) {
  std::vector<Real> f(std::size_t(n) + 1, Real(1));
  for (std::size_t i = 1; i < f.size(); ++i) f[i] = f[i - 1] * Real(i);
  return f;
}

/// Regular solid harmonics to degree lmax, orders m >= 0, sorted by l, then m.
std::vector<Complex> solid_harmonics(const std::array<Real, 3>& d, int lmax) {
  std::vector<Complex> r(Multipoles::count(lmax));
  const Real square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  const auto at = [&](int l, int m) -> Complex& { return r[Multipoles::by_degree(l, m)]; };
  at(0, 0) = 1;
  for (int m = 0; m <= lmax; ++m) {
    if (m > 0) at(m, m) = at(m - 1, m - 1) * Complex(d[0], d[1]) * (Real(-1) / Real(2 * m));
    for (int l = m + 1; l <= lmax; ++l) {
      const Complex before = l - 2 >= m ? at(l - 2, m) : Complex(0);
      at(l, m) = (Real(2 * l - 1) * d[2] * at(l - 1, m) - square * before) / (Real(l + m) * Real(l - m));
    }
  }
  return r;
}

/// Of any order: R_l,-m = (-1)^m conj R_lm.
Complex of_order(const std::vector<Complex>& r, int l, int m) {
  const Complex value = r[Multipoles::by_degree(l, std::abs(m))];
  return m >= 0 ? value : (m % 2 == 0 ? Real(1) : Real(-1)) * std::conj(value);
}

/// log2 of C(l, k).
double log_binomial(int l, int k) {
  return (std::lgamma(l + 1.0) - std::lgamma(k + 1.0) - std::lgamma(l - k + 1.0)) / std::numbers::ln2;
}

} // namespace

std::optional<MomentProblem> near_problem(const MomentProblem& far) {
  if (far.lmax > largest_degree_moved || far.faces.empty()) return std::nullopt;
  MomentProblem near = far;
  const Box box = bounding_box(far.vertices, far.faces);
  near.origin = box.middle();
  if ((near.origin - far.origin).norm() < least_distance * box.longest_side() / 2) return std::nullopt;
  near.reference_radius = brillouin_radius(far.vertices, far.faces, near.origin);
  if (!(near.reference_radius > 0)) return std::nullopt;
  const double distance = double(length(shift(far, near))) * (far.reference_radius / near.reference_radius);
  if (!(distance >= std::max(least_distance, far.lmax / 2.0))) return std::nullopt;
  near.lmax = 0;
  while (near.lmax < far.lmax &&
         log_binomial(far.lmax, near.lmax + 1) - (near.lmax + 1) * std::log2(distance) > std::log2(least_term))
    ++near.lmax;
  return near;
}

std::vector<long double> translated(const MomentProblem& far, const MomentProblem& near,
                                    std::span<const long double> moments) {
  const std::vector<Real> factorial = factorials(2 * far.lmax);
  const auto scale = [&](int l, int m) {
    return std::sqrt(Real(2 * l + 1) / (4 * std::numbers::pi_v<Real>)) * std::sqrt(factorial[std::size_t(l - m)]) *
           std::sqrt(factorial[std::size_t(l + m)]);
  };
  const std::vector<Complex> harmonics = solid_harmonics(shift(far, near), far.lmax);
  std::vector<Complex> body(Multipoles::count(near.lmax));
  const Real ratio = Real(near.reference_radius) / Real(far.reference_radius);
  Real power = 1;
  for (int k = 0; k <= near.lmax; ++k, power *= ratio)
    for (int j = 0; j <= k; ++j) {
      const std::size_t i = Multipoles::index(near.lmax, k, j);
      body[Multipoles::by_degree(k, j)] = Complex(moments[2 * i], moments[2 * i + 1]) * (power / scale(k, j));
    }
  std::vector<Real> result(2 * Multipoles::count(far.lmax));
  parallel_for(0, std::size_t(far.lmax) + 1, [&](std::size_t degree, unsigned) {
    const int l = int(degree);
    for (int m = 0; m <= l; ++m) {
      Real re = 0, im = 0;
      for (int k = std::min(l, near.lmax); k >= 0; --k) // the smallest terms first
        for (int j = std::max(-k, m - (l - k)); j <= std::min(k, m + (l - k)); ++j) {
          const Complex a = of_order(body, k, j), b = of_order(harmonics, l - k, m - j);
          re += a.real() * b.real() - a.imag() * b.imag();
          im += a.real() * b.imag() + a.imag() * b.real();
        }
      const std::size_t i = Multipoles::index(far.lmax, l, m);
      result[2 * i] = re * scale(l, m);
      result[2 * i + 1] = m == 0 ? 0 : im * scale(l, m);
    }
  });
  return result;
}

Multipoles translated(const MomentProblem& far, const MomentProblem& near, const Multipoles& moments) {
  std::vector<Real> values;
  for (const std::complex<double>& q : moments.values) {
    values.push_back(q.real());
    values.push_back(q.imag());
  }
  const std::vector<Real> moved = translated(far, near, values);
  Multipoles result(far);
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] = {double(moved[2 * i]), double(moved[2 * i + 1])};
  return result;
}

std::vector<double> translated_error(const MomentProblem& far, const MomentProblem& near, std::span<const double> error,
                                     double bound) {
  const double distance = double(length(shift(far, near)));
  const double ratio = near.reference_radius / far.reference_radius;
  std::vector<double> result;
  for (int l = 0; l <= far.lmax; ++l) {
    double squares = 0;
    for (int k = 0; k <= std::min(l, near.lmax); ++k) {
      const double factor = std::exp2(log_binomial(l, k) + (l - k) * std::log2(distance) + k * std::log2(ratio)) *
                            std::sqrt((2.0 * l + 1) / (2.0 * k + 1));
      squares += factor * error[std::size_t(k)] * factor * error[std::size_t(k)];
    }
    double left_out = 0;
    if (const int k = near.lmax + 1; k <= l)
      left_out = 2 * std::sqrt(2.0 * l + 1) * bound *
                 std::exp2(log_binomial(l, k) + (l - k) * std::log2(distance) + k * std::log2(ratio));
    result.push_back(std::sqrt(squares) + left_out);
  }
  return result;
}

} // namespace cowgpu
