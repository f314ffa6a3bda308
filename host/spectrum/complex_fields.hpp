// Complex fields on the sphere: two real fields that share the Legendre recursion.
#pragma once

#include "host/monitor.hpp"
#include "host/sphere_coefficients.hpp"
#include "host/sphere_transform.hpp"

#include <complex>
#include <cstddef>
#include <vector>

namespace cowgpu {

/// Coefficients c_lm of complex fields f = sum_l sum_{m=-l..l} c_lm Y_lm, Y_lm as in SphereCoefficients. One field after
/// the other; within a field sorted by l, then m.
struct ComplexCoefficients {
  int lmax = 0;
  int fields = 1;
  std::vector<std::complex<double>> values; ///< fields * count(lmax)

  ComplexCoefficients() = default;
  ComplexCoefficients(int lmax_, int fields_)
      : lmax(lmax_), fields(fields_), values(std::size_t(fields_) * count(lmax_)) {}

  /// Where (l, m) stands within a field, -l <= m <= l <= lmax.
  static constexpr std::size_t index(int l, int m) { return std::size_t(l * (l + 1) + m); }
  /// Coefficients of a field: (lmax + 1)^2.
  static constexpr std::size_t count(int lmax) { return std::size_t(lmax + 1) * std::size_t(lmax + 1); }

  std::complex<double>& at(int f, int l, int m) { return values[std::size_t(f) * count(lmax) + index(l, m)]; }
  std::complex<double> at(int f, int l, int m) const { return values[std::size_t(f) * count(lmax) + index(l, m)]; }
};

/// The real and the imaginary part of each field, in turn: f = g + i h with
///   g_lm = (c_lm + (-1)^m conj(c_l,-m)) / 2,  h_lm = (c_lm - (-1)^m conj(c_l,-m)) / 2i.
SphereCoefficients split(const ComplexCoefficients& coefficients);

/// The inverse of split(): c_lm = g_lm + i h_lm, c_l,-m = (-1)^m (conj(g_lm) + i conj(h_lm)). Imaginary parts of g_l0 and
/// h_l0 are ignored. Throws Error(bad_argument) for an odd number of fields.
ComplexCoefficients join(const SphereCoefficients& parts);

/// Fields on the transform's grid, [field][ring][longitude]. coefficients.lmax must be transform.lmax(). Any number of
/// fields. Throws what SphereTransform::synthesise() throws.
std::vector<std::complex<double>> synthesise(SphereTransform& transform, const ComplexCoefficients& coefficients,
                                             Monitor& monitor);

/// Coefficients to degree transform.lmax(), exact for fields of at most that degree. `values` are [field][ring][longitude];
/// their number must be a multiple of the grid's points. Throws what SphereTransform::analyse() throws.
ComplexCoefficients analyse(SphereTransform& transform, const std::vector<std::complex<double>>& values,
                            Monitor& monitor);

} // namespace cowgpu
