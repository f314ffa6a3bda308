// Multipole moments of a body together with everything needed to read them.
#pragma once

#include "host/moment_problem.hpp"
#include "host/sphere_coefficients.hpp"
#include "host/types.hpp"

#include <complex>
#include <vector>

namespace cowgpu {

/// Multipole moments Q_lm of a body, divided by R^l.
///
/// Q_lm = integral over the body of density * r^l Y_lm(theta, phi), about `origin`, not conjugated; Y_lm complex,
/// orthonormal on the unit sphere, with the Condon-Shortley phase; theta from +z, phi from +x towards +y, axes those of
/// the mesh. Only m >= 0 is held: Q_l,-m = (-1)^m conj(Q_lm) for a real density.
///
/// One field in memory: `values` are Q_lm / R^l in the order of SphereCoefficients. What files call the field of multipoles
/// has their complex conjugates as coefficients (CoefficientKind::multipoles).
struct Multipoles : SphereCoefficients {
  Vec3 origin = Vec3::Zero();  ///< in mesh coordinates, mesh length units
  double reference_radius = 1; ///< R, mesh length units
  double density = 1;          ///< mass per cubed mesh length unit that went into the values

  Multipoles() = default; ///< no values
  /// All zero, to degree lmax.
  explicit Multipoles(int lmax_) : SphereCoefficients(lmax_, 1) {}
  /// All zero; degree, origin, radius and density are the problem's.
  explicit Multipoles(const MomentProblem& problem)
      : SphereCoefficients(problem.lmax, 1), origin(problem.origin), reference_radius(problem.reference_radius),
        density(problem.density) {}

  std::complex<double>& operator()(int l, int m) { return at(0, l, m); }
  std::complex<double> operator()(int l, int m) const { return at(0, l, m); }
};

/// Norm of degree l over all orders, negative ones included: sqrt(sum_m |Q_lm / R^l|^2).
double degree_norm(const Multipoles& moments, int l);

/// degree_norm() of degrees 0 to lmax.
std::vector<double> degree_norms(const Multipoles& moments);

} // namespace cowgpu
