// The series of a body's potential degree by degree: what each order leaves out, at places and over whole spheres.
#pragma once

#include "host/multipoles.hpp"
#include "host/sphere_coefficients.hpp"
#include "host/types.hpp"

#include <array>
#include <complex>
#include <span>
#include <vector>

namespace cowgpu::physics {

/// The terms of one degree l of V = integral of density/|x - y| and of its gradient, at a point.
struct DegreeTerm {
  double value = 0;
  Vec3 gradient = Vec3::Zero();
};

/// V and the components of its gradient as sums of J_lm(x) = R^(l+1) Y_lm(x/r)/r^(l+1), whose derivatives are such functions
/// of the next degree (the equations stand in host/reference/potential.hpp). In units of mass over R and over R^2.
class PotentialTerms {
public:
  /// Points that at() takes together.
  static constexpr std::size_t group = 8;

  explicit PotentialTerms(const Multipoles& moments);
  int lmax() const { return lmax_; }

  /// Terms of degrees 0 ... lmax (at most lmax()) at up to `group` points in units of R, outside the unit sphere:
  /// terms[l * group + point].
  void at(std::span<const Vec3> points, int lmax, std::vector<DegreeTerm>& terms) const;

  /// Degrees least ... most of V and its gradient on the sphere of radius d R as four fields of coefficients to degree
  /// most + 1, each degree l of V with degree l + 1 of the gradient.
  SphereCoefficients on_sphere(double d, int least, int most) const;

private:
  using Complex = std::complex<double>;
  Complex coefficient(std::size_t set, int l, int m) const {
    return sets_[set][SphereCoefficients::index(lmax_ + 1, l, m)];
  }
  int lmax_;
  std::vector<std::array<double, 2>> recursion_; // a and b of J_{l+1,m} = a z' J_lm - b q J_{l-1,m}
  std::array<std::vector<Complex>, 4> sets_;     // to degree lmax + 1, m >= 0, in the order of SphereCoefficients
};

} // namespace cowgpu::physics
