// Spherical-harmonic coefficients of fields on the sphere.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace cowgpu {

/// Coefficients a_lm of real fields f(theta, phi) = sum_l sum_{m=-l..l} a_lm Y_lm(theta, phi), Y_lm complex, orthonormal
/// on the unit sphere, with the Condon-Shortley phase. Only m >= 0 is held: a_l,-m = (-1)^m conj(a_lm), and a_l0 is real.
///
/// One field after the other; within a field sorted by m, then l, the order in which transforms work.
struct SphereCoefficients {
  int lmax = 0;
  int fields = 1;
  std::vector<std::complex<double>> values; ///< fields * count(lmax)

  SphereCoefficients() = default;
  SphereCoefficients(int lmax_, int fields_)
      : lmax(lmax_), fields(fields_), values(std::size_t(fields_) * count(lmax_)) {}

  /// Where (l, m) stands within a field, 0 <= m <= l <= lmax.
  static constexpr std::size_t index(int lmax, int l, int m) {
    return std::size_t(m) * std::size_t(2 * lmax + 1 - m) / 2 + std::size_t(l);
  }
  /// Coefficients of a field: (lmax + 1)(lmax + 2) / 2.
  static constexpr std::size_t count(int lmax) { return std::size_t(lmax + 1) * std::size_t(lmax + 2) / 2; }

  /// Where (l, m) stands among numbers sorted by l, then m: the order of work that goes degree by degree.
  static constexpr std::size_t by_degree(int l, int m) {
    return std::size_t(l) * (std::size_t(l) + 1) / 2 + std::size_t(m);
  }

  std::span<std::complex<double>> field(int f) {
    return std::span(values).subspan(std::size_t(f) * count(lmax), count(lmax));
  }
  std::span<const std::complex<double>> field(int f) const {
    return std::span(values).subspan(std::size_t(f) * count(lmax), count(lmax));
  }
  std::complex<double>& at(int f, int l, int m) { return values[std::size_t(f) * count(lmax) + index(lmax, l, m)]; }
  std::complex<double> at(int f, int l, int m) const {
    return values[std::size_t(f) * count(lmax) + index(lmax, l, m)];
  }
};

} // namespace cowgpu
