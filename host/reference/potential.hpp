// Reference of the stage `potential`: plain scalar code on any number type, the oracle of both fast paths, and good for a
// field at one place.
//
// With the irregular solid harmonics I_lm(x) = Y_lm(x/r) / r^(l+1) (E. W. Hobson, The Theory of Spherical and Ellipsoidal
// Harmonics, 1931, ch. IV) outside a sphere of radius R that holds the body
//   V(x) = integral of density(y) / |x - y| = sum_lm 4 pi/(2l+1) conj(Q_lm) I_lm(x),
// and derivatives of I_lm are such harmonics of the next degree; with k = (2l+1)/(2l+3)
//   d/dz I_lm           = -sqrt(k (l+1-m)(l+1+m)) I_{l+1,m}
//   (d/dx + i d/dy) I_lm = sqrt(k (l+m+1)(l+m+2)) I_{l+1,m+1}.
#pragma once

#include "host/multipoles.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

namespace cowgpu::reference {

/// V, its gradient and its second derivatives, in mass (or charge) over length, its square and its cube; V > 0 for a
/// positive density. Gravity: potential -G V, acceleration G grad V, gradient of the acceleration G dd V. Charges: potential
/// k V, field -k grad V.
template <class Real>
struct PotentialAt {
  Real value{};
  Eigen::Matrix<Real, 3, 1> gradient = Eigen::Matrix<Real, 3, 1>::Zero();
  Eigen::Matrix<Real, 3, 3> hessian = Eigen::Matrix<Real, 3, 3>::Zero();
};

/// The series of a body's moments to a degree:
///   ExteriorPotential<long double> field(moments, 6);
///   field({x, y, z}).gradient
template <class Real>
class ExteriorPotential {
public:
  using Vector = Eigen::Matrix<Real, 3, 1>;
  using Complex = std::complex<Real>;

  /// Degrees 0 ... min(lmax, moments.lmax). The moments are copied.
  explicit ExteriorPotential(const Multipoles& moments, int lmax = 1 << 30)
      : lmax_(std::min(lmax, moments.lmax)), radius_(Real(moments.reference_radius)) {
    using std::sqrt, std::acos;
    for (int k = 0; k <= 2 * lmax_ + 7; ++k) root_.push_back(sqrt(Real(k)));
    const Real four_pi = 4 * acos(Real(-1));
    first_ = 1 / sqrt(four_pi);
    for (int l = 0; l <= lmax_; ++l)
      for (int m = 0; m <= l; ++m) {
        const Real scale = four_pi / Real(2 * l + 1);
        const std::complex<double> q = moments(l, m);
        terms_.emplace_back(scale * Real(q.real()), m == 0 ? Real(0) : -scale * Real(q.imag()));
      }
  }

  int lmax() const { return lmax_; }

  /// At x, seen from the moments' origin; not at the origin itself. Inside the sphere that holds the body the sum is that of
  /// the series, and not the potential.
  PotentialAt<Real> operator()(const Vector& x) const {
    const std::vector<Complex> harmonics = irregular_harmonics(x);
    const auto harmonic = [&](int l, int m) {
      const Complex h = harmonics[Multipoles::by_degree(l, std::abs(m))];
      return m >= 0 ? h : m % 2 ? -std::conj(h) : std::conj(h);
    };
    const auto along_z = [&](int l, int m) {
      return -root(2 * l + 1) / root(2 * l + 3) * root(l + 1 - m) * root(l + 1 + m);
    };
    const auto across = [&](int l, int m) {
      return root(2 * l + 1) / root(2 * l + 3) * root(l + m + 1) * root(l + m + 2);
    };
    Real v(0), z(0), zz(0);
    Complex p(0), pz(0), pp(0); // d/dx + i d/dy is p
    for (int l = lmax_; l >= 0; --l)
      for (int m = -l; m <= l; ++m) {
        Complex a = terms_[Multipoles::by_degree(l, std::abs(m))];
        if (m < 0) a = m % 2 ? -std::conj(a) : std::conj(a);
        v += (a * harmonic(l, m)).real();
        z += along_z(l, m) * (a * harmonic(l + 1, m)).real();
        p += across(l, m) * (a * harmonic(l + 1, m + 1));
        zz += along_z(l, m) * along_z(l + 1, m) * (a * harmonic(l + 2, m)).real();
        pz += across(l, m) * along_z(l + 1, m + 1) * (a * harmonic(l + 2, m + 1));
        pp += across(l, m) * across(l + 1, m + 1) * (a * harmonic(l + 2, m + 2));
      }
    PotentialAt<Real> at;
    at.value = v / radius_;
    at.gradient = Vector(p.real(), p.imag(), z) / (radius_ * radius_);
    // Laplace: xx + yy = -zz, and pp = xx - yy + 2i xy.
    const Real xx = (pp.real() - zz) / 2, yy = (-pp.real() - zz) / 2, xy = pp.imag() / 2;
    at.hessian << xx, xy, pz.real(), xy, yy, pz.imag(), pz.real(), pz.imag(), zz;
    at.hessian /= radius_ * radius_ * radius_;
    return at;
  }

private:
  Real root(int k) const { return root_[std::size_t(k)]; }

  // R^(l+1) I_lm to degree lmax + 2, m >= 0, by recursion over l from I_mm.
  std::vector<Complex> irregular_harmonics(const Vector& x) const {
    using std::sqrt;
    const int top = lmax_ + 2;
    std::vector<Complex> h(Multipoles::count(top));
    // Divided before squares are formed: they neither overflow nor vanish.
    const Vector u = x / radius_;
    const Real r2 = u.squaredNorm(), z = u[2] / r2;
    const Complex across(u[0] / r2, u[1] / r2);
    Complex start(first_ / sqrt(r2));
    for (int m = 0; m <= top; ++m) {
      if (m > 0) start = start * across * (-root(2 * m + 1) / root(2 * m));
      h[Multipoles::by_degree(m, m)] = start;
      for (int l = m + 1; l <= top; ++l) {
        const Real a = root(2 * l - 1) * root(2 * l + 1) / (root(l - m) * root(l + m));
        Complex next = a * z * h[Multipoles::by_degree(l - 1, m)];
        if (l > m + 1) {
          const Real b = a * root(l - 1 - m) * root(l - 1 + m) / (root(2 * l - 3) * root(2 * l - 1));
          next -= b / r2 * h[Multipoles::by_degree(l - 2, m)];
        }
        h[Multipoles::by_degree(l, m)] = next;
      }
    }
    return h;
  }

  int lmax_;
  Real radius_, first_{};
  std::vector<Real> root_;     // square roots of 0, 1, 2 ...
  std::vector<Complex> terms_; // 4 pi/(2l+1) conj(Q_lm) / R^l
};

} // namespace cowgpu::reference
