// Real solid harmonics, their derivatives, and the exchange of two axes.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace cowgpu::plan {

/// Orders of expansions: degrees 0 ... order.
inline constexpr int largest_expansion_order = 32;

/// Schmidt semi-normalised: with C_lm = R_lm of cosine, S_lm of sine, and P_lm without the phase (-1)^m,
///   C_lm + i S_lm = sqrt((2 - [m = 0]) (l-m)!/(l+m)!) r^l P_lm(cos theta) e^(i m phi),
/// so that sum over m of R_lm(x) R_lm(y) = |x|^l |y|^l P_l(cos of the angle between them), and
///   1/|x - y| = sum R_lm(y) R_lm(x)/|x|^(2l+1),  |y| < |x|.
inline constexpr std::size_t harmonics(int order) {
  return std::size_t(order + 1) * std::size_t(order + 1);
}
inline constexpr std::size_t cosine_index(int l, int m) {
  return std::size_t(l * l + m);
}
inline constexpr std::size_t sine_index(int l, int m) { ///< m > 0
  return std::size_t(l * l + l + m);
}

/// Factors of recursions between them.
struct HarmonicFactors {
  template <class T>
  using Square = std::array<std::array<T, largest_expansion_order + 2>, largest_expansion_order + 2>; // [l][m]

  std::array<double, largest_expansion_order + 2> diagonal; ///< R_mm = diagonal (x + i y) R_(m-1)(m-1)
  Square<double> rise, fall;                                ///< R_lm = rise z R_(l-1)m - fall r^2 R_(l-2)m, m < l
  Square<double> norm; ///< R_lm = norm rho_lm, with rho_lm = r^l P_lm e^(i m phi)/(l+m)!

  /// d/dz R_lm = along R_(l-1)m; with C and S, where m > 0, in terms of degree l - 1,
  ///   d/dx C_m = down C_(m-1) - up C_(m+1),     d/dx S_m = down S_(m-1) - up S_(m+1),
  ///   d/dy C_m = -down S_(m-1) - up S_(m+1),    d/dy S_m = down C_(m-1) + up C_(m+1),
  /// and d/dx C_0 = -up C_1, d/dy C_0 = -up S_1.
  Square<double> along, down, up;

  /// Exchange of x and z: C_lk(z, y, x) = sum over m of cosines[l][m (l+1) + k] C_lm(x, y, z), the same for sines; both
  /// symmetric. Those of cosines vanish where l + m + k is odd, those of sines where it is even.
  std::array<std::vector<double>, largest_expansion_order + 1> cosines, sines;
};
const HarmonicFactors& harmonic_factors();

} // namespace cowgpu::plan
