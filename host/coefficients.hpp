// Spherical-harmonic coefficients together with everything needed to read them.
#pragma once

#include "host/types.hpp"

#include <complex>
#include <cstddef>
#include <vector>

namespace cowgpu {

/// Multipole moments Q_lm of a body, divided by R^l.
///
/// Q_lm = integral over the body of density * r^l Y_lm(theta, phi), about `origin`, not conjugated; Y_lm complex,
/// orthonormal on the unit sphere, with the Condon-Shortley phase; theta from +z, phi from +x towards +y, axes those of
/// the mesh. Only m >= 0 is held: Q_l,-m = (-1)^m conj(Q_lm) for a real density.
struct Coefficients {
  int lmax = 0;
  Vec3 origin = Vec3::Zero();               ///< in mesh coordinates, mesh length units
  double reference_radius = 1;              ///< R, mesh length units
  double density = 1;                       ///< mass per cubed mesh length unit that went into the values
  std::vector<std::complex<double>> values; ///< Q_lm / R^l, (lmax+1)(lmax+2)/2 of them, sorted by l, then m

  /// Where (l, m) stands in `values`, 0 <= m <= l.
  static constexpr std::size_t index(int l, int m) {
    return std::size_t(l) * (std::size_t(l) + 1) / 2 + std::size_t(m);
  }
  static constexpr std::size_t count(int lmax) { return index(lmax + 1, 0); }

  std::complex<double> operator()(int l, int m) const { return values[index(l, m)]; }
};

/// Norm of degree l over all orders, negative ones included: sqrt(sum_m |Q_lm / R^l|^2).
double degree_norm(const Coefficients& coefficients, int l);

} // namespace cowgpu
