// Reference of expansions in solid harmonics: moments by quadrature, translations by plain sums, on any number type.
#pragma once

#include <Eigen/Core>

#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

namespace cowgpu::reference {

/// Coefficients of real solid harmonics of degrees 0 ... order, Schmidt semi-normalised: the cosine of (l, m) at l^2 + m, the
/// sine at l^2 + l + m.
///   A multipole expansion stands for sum M_lm R_lm(x)/|x|^(2l+1), a local one for sum L_lm R_lm(x), x seen from the centre.
/// Inside, harmonics are the complex rho_lm = r^l P_lm e^(i m phi)/(l+m)! and iota_lm = (l-m)! r^(-l-1) P_lm e^(i m phi),
/// P_lm without the phase (-1)^m, whose translations have no factors (L. Greengard and V. Rokhlin, Acta Numerica 6 (1997) 229).
template <class Real>
class SolidExpansions {
public:
  using Vector = Eigen::Matrix<Real, 3, 1>;
  using Complex = std::complex<Real>;
  using Coefficients = std::vector<Real>;

  explicit SolidExpansions(int order) : order_(order) {}
  std::size_t size() const { return std::size_t((order_ + 1) * (order_ + 1)); }

  /// R_lm(x).
  Coefficients regular(const Vector& x) const;
  Real at(const Coefficients& local, const Vector& x) const;
  Real far(const Coefficients& multipole, const Vector& x) const;

  /// Integral of R_lm over a triangle, corners seen from the centre, by a quadrature that is exact for its polynomials.
  Coefficients triangle(const Vector& a, const Vector& b, const Vector& c) const;

  /// About another centre, at `shift` from the old one.
  Coefficients multipole_to_multipole(const Coefficients& from, const Vector& shift) const;
  Coefficients multipole_to_local(const Coefficients& from, const Vector& shift) const;
  Coefficients local_to_local(const Coefficients& from, const Vector& shift) const;

private:
  // rho_lm and iota_lm for all |m| <= l <= order; (l, m) at l^2 + l + m.
  static std::size_t index(int l, int m) { return std::size_t(l * l + l + m); }
  static std::vector<Complex> inner(int order, const Vector& x);
  static std::vector<Complex> outer(int order, const Vector& x);
  static Real norm(int l, int m) { // R_lm = norm rho_lm
    Real product = m > 0 ? 2 : 1;
    for (int k = 2; k <= l + m; ++k) product *= Real(k);
    for (int k = 2; k <= l - m; ++k) product *= Real(k);
    return std::sqrt(product);
  }
  static Real sign(int m) { return m % 2 == 0 ? 1 : -1; }
  // The sums of charges times rho_lm (of a multipole expansion), or what conj(rho_lm) is multiplied with (of a local one).
  std::vector<Complex> to_complex(const Coefficients& from, bool local) const;
  Coefficients to_real(const std::vector<Complex>& from, bool local) const;

  int order_;
};

template <class Real>
auto SolidExpansions<Real>::inner(int order, const Vector& x) -> std::vector<Complex> {
  std::vector<Complex> rho(std::size_t((order + 1) * (order + 1)));
  const Real r2 = x.squaredNorm();
  for (int m = 0; m <= order; ++m) {
    rho[index(m, m)] = m == 0 ? Complex(1) : rho[index(m - 1, m - 1)] * Complex(x[0], x[1]) / Real(2 * m);
    for (int l = m + 1; l <= order; ++l) {
      const Complex last = l - 2 >= m ? rho[index(l - 2, m)] : Complex(0);
      rho[index(l, m)] = (Real(2 * l - 1) * x[2] * rho[index(l - 1, m)] - r2 * last) / Real(l * l - m * m);
    }
    for (int l = m; m > 0 && l <= order; ++l) rho[index(l, -m)] = sign(m) * std::conj(rho[index(l, m)]);
  }
  return rho;
}

template <class Real>
auto SolidExpansions<Real>::outer(int order, const Vector& x) -> std::vector<Complex> {
  std::vector<Complex> iota(std::size_t((order + 1) * (order + 1)));
  const Real r2 = x.squaredNorm();
  iota[0] = 1 / std::sqrt(r2);
  for (int m = 0; m <= order; ++m) {
    if (m > 0) iota[index(m, m)] = iota[index(m - 1, m - 1)] * Complex(x[0], x[1]) * (Real(2 * m - 1) / r2);
    for (int l = m + 1; l <= order; ++l) {
      const Complex last = l - 2 >= m ? iota[index(l - 2, m)] : Complex(0);
      iota[index(l, m)] =
          (Real(2 * l - 1) * x[2] * iota[index(l - 1, m)] - Real((l - 1) * (l - 1) - m * m) * last) / r2;
    }
    for (int l = m; m > 0 && l <= order; ++l) iota[index(l, -m)] = sign(m) * std::conj(iota[index(l, m)]);
  }
  return iota;
}

template <class Real>
auto SolidExpansions<Real>::to_complex(const Coefficients& from, bool local) const -> std::vector<Complex> {
  std::vector<Complex> to(size());
  for (int l = 0; l <= order_; ++l)
    for (int m = 0; m <= l; ++m) {
      const Complex both(from[std::size_t(l * l + m)], m > 0 ? from[std::size_t(l * l + l + m)] : 0);
      to[index(l, m)] = local ? both * norm(l, m) / Real(m > 0 ? 2 : 1) : both / norm(l, m);
      if (m > 0) to[index(l, -m)] = sign(m) * std::conj(to[index(l, m)]);
    }
  return to;
}

template <class Real>
auto SolidExpansions<Real>::to_real(const std::vector<Complex>& from, bool local) const -> Coefficients {
  Coefficients to(size());
  for (int l = 0; l <= order_; ++l)
    for (int m = 0; m <= l; ++m) {
      const Complex both = from[index(l, m)] * (local ? Real(m > 0 ? 2 : 1) / norm(l, m) : norm(l, m));
      to[std::size_t(l * l + m)] = both.real();
      if (m > 0) to[std::size_t(l * l + l + m)] = both.imag();
    }
  return to;
}

template <class Real>
auto SolidExpansions<Real>::regular(const Vector& x) const -> Coefficients {
  return to_real(inner(order_, x), false);
}

template <class Real>
Real SolidExpansions<Real>::at(const Coefficients& local, const Vector& x) const {
  const Coefficients harmonics = regular(x);
  Real sum = 0;
  for (std::size_t i = harmonics.size(); i-- > 0;) sum += local[i] * harmonics[i];
  return sum;
}

template <class Real>
Real SolidExpansions<Real>::far(const Coefficients& multipole, const Vector& x) const {
  return at(multipole, x / x.squaredNorm()) / x.norm();
}

template <class Real>
auto SolidExpansions<Real>::triangle(const Vector& a, const Vector& b, const Vector& c) const -> Coefficients {
  // Gauss's nodes in both directions, one folded into the corner a (Duffy), whose factor takes a degree.
  const int count = order_ / 2 + 2;
  std::vector<std::pair<Real, Real>> nodes;
  for (int i = 0; i < count; ++i) {
    Real x = std::cos(std::numbers::pi_v<Real> * (Real(i) + Real(3) / 4) / (Real(count) + Real(1) / 2)), slope = 1;
    for (int step = 0; step < 50; ++step) {
      Real last = 1, value = x;
      for (int k = 2; k <= count; ++k)
        last = std::exchange(value, (Real(2 * k - 1) * x * value - Real(k - 1) * last) / Real(k));
      slope = Real(count) * (x * value - last) / (x * x - 1);
      x -= value / slope;
    }
    nodes.emplace_back((1 + x) / 2, 1 / ((1 - x * x) * slope * slope));
  }
  const Vector across = (b - a).cross(c - a);
  const Real twice_area = across.norm();
  Coefficients sum(size());
  for (const auto& [u, weight_u] : nodes)
    for (const auto& [v, weight_v] : nodes) {
      const Coefficients at = regular(a + u * ((b - a) + v * (c - b)));
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight_u * weight_v * u * twice_area * at[i];
    }
  return sum;
}

template <class Real>
auto SolidExpansions<Real>::multipole_to_multipole(const Coefficients& from, const Vector& shift) const
    -> Coefficients {
  const auto source = to_complex(from, false), shifts = inner(order_, -shift);
  std::vector<Complex> to(size());
  for (int j = 0; j <= order_; ++j)
    for (int k = -j; k <= j; ++k)
      for (int l = 0; l <= j; ++l)
        for (int m = -l; m <= l; ++m)
          if (std::abs(k - m) <= j - l) to[index(j, k)] += source[index(l, m)] * shifts[index(j - l, k - m)];
  return to_real(to, false);
}

template <class Real>
auto SolidExpansions<Real>::multipole_to_local(const Coefficients& from, const Vector& shift) const -> Coefficients {
  const auto source = to_complex(from, false), shifts = outer(2 * order_, shift);
  std::vector<Complex> to(size());
  for (int j = 0; j <= order_; ++j)
    for (int k = -j; k <= j; ++k)
      for (int l = 0; l <= order_; ++l)
        for (int m = -l; m <= l; ++m)
          to[index(j, k)] += sign(j) * std::conj(source[index(l, m)]) * shifts[index(l + j, m + k)];
  return to_real(to, true);
}

template <class Real>
auto SolidExpansions<Real>::local_to_local(const Coefficients& from, const Vector& shift) const -> Coefficients {
  const auto source = to_complex(from, true), shifts = inner(order_, shift);
  std::vector<Complex> to(size());
  for (int j = 0; j <= order_; ++j)
    for (int k = -j; k <= j; ++k)
      for (int l = j; l <= order_; ++l)
        for (int m = -l; m <= l; ++m)
          if (std::abs(m - k) <= l - j) to[index(j, k)] += source[index(l, m)] * std::conj(shifts[index(l - j, m - k)]);
  return to_real(to, true);
}

} // namespace cowgpu::reference
