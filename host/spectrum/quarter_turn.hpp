// Rotation of spherical-harmonic coefficients by 90 degrees about the y axis: the one rotation that costs O(lmax^3).
//
// With d^l_mm' = d^l_mm'(pi/2), Wigner's small d-matrix (host/spectrum/rotation.hpp), and a_l,-m = (-1)^m conj(a_lm),
// d^l_{m,-m'} = (-1)^{l+m} d^l_mm' leaves of b_lm = sum_{m'=-l..l} d^l_mm' a_lm'
//   Re b_lm = sum of d^l_mm' c_m' Re a_lm' over m' = 0 ... l with l + m + m' even,
//   Im b_lm = sum of d^l_mm' c_m' Im a_lm' over m' = 1 ... l with l + m + m' odd,      c_0 = 1, c_m' = 2.
// For each (m, m') the d^l follow by the three-term recurrence in l (Varshalovich, Moskalev, Khersonskii, Quantum Theory
// of Angular Momentum, 4.8; Kostelec and Rockmore, J. Fourier Anal. Appl. 14 (2008) 145), at pi/2
//   l k_{l+1}(m) k_{l+1}(m') d^{l+1} = -(2l+1) m m' d^l - (l+1) k_l(m) k_l(m') d^{l-1},  k_l(m) = sqrt(l^2 - m^2),
// which is run upwards only, its stable direction, from l = max(m, m'):
//   d^m_mm' = (-1)^{m-m'} 2^-m sqrt(binomial(2m, m - m')) for m' <= m,
//   d^m'_mm' = 2^-m' sqrt(binomial(2m', m' - m)) for m < m'.
// d^l = w_l(m) w_l(m') v_l u_l with w_{l+1} w_l k_{l+1} = 1, w_m = w_{m+1} and v_{l+1} v_l = l + 1, v_0 = 1 makes it
//   u_{l+1} = t_l u_l - u_{l-1},  t_l = -(2l+1) v_l^2 / (l (l+1)) m w_l(m)^2 m' w_l(m')^2,
// three operations for one (l, m, m'), its product with a_lm' included; the factors w are taken into a and b.
// Start values far below the range of doubles carry an exponent of their own.
#pragma once

#include "host/monitor.hpp"

#include <hwy/aligned_allocator.h>

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace cowgpu {

/// The rotation, prepared for one lmax. It and apply() hold 12 (lmax + 17)^2 + 1728 (lmax + 1) * threads bytes at most.
class QuarterTurn {
public:
  /// 0 <= lmax <= largest_grid_degree. `threads` 0: all.
  QuarterTurn(int lmax, unsigned threads);

  /// Coefficients of one field, in the order of SphereCoefficients, replaced by those of the field turned by +90 degrees
  /// about y (z goes to x). Imaginary parts at m = 0 are ignored. Progress runs from `done` to `done + share`. The same
  /// bits for any number of threads. Throws Error(interrupted); the coefficients are then of no use.
  void apply(std::span<std::complex<double>> coefficients, Monitor& monitor, double done = 0, double share = 1);

  /// Orders m' side by side in a vector; orders m in step; orders m of a task.
  static constexpr int lanes = 8, group = 4, task_orders = 16;

  /// What the kernel reads: per block of `lanes` orders m' rows for l = first order ... lmax.
  struct Tables {
    int lmax = 0, blocks = 0;
    std::vector<std::size_t> offset;               ///< where each block's first row begins, in doubles
    hwy::AlignedFreeUniquePtr<double[]> factor;    ///< m' w_l(m')^2; 0 for l < m'
    hwy::AlignedFreeUniquePtr<double[]> even, odd; ///< c w_l(m') times Re a_lm' and Im a_lm' where l + m is even, odd
    const double* row(const double* array, int block, int l) const {
      return array + offset[std::size_t(block)] + std::size_t(l - block * lanes) * lanes;
    }
  };

  /// One order m at work. Values are mantissas times 2^(768 scale), scale <= 0; lanes below the range do not count.
  struct Row {
    int m = 0;
    const double* step = nullptr;     ///< [l]: -(2l+1) v_l^2 / (l (l+1)) m w_l(m)^2
    const double* start = nullptr;    ///< [m']: u at l = max(m, m')
    const int* start_scale = nullptr; ///< [m']
    double* sums = nullptr;           ///< [l][lane]: of u times the packed coefficients
    std::array<double, lanes> previous, current;
    std::array<int, lanes> scale;
  };
  static constexpr double unit = 0x1p-768, rescale_above = 0x1p600;

private:
  void pack(std::span<const std::complex<double>> coefficients);

  unsigned threads_;
  Tables tables_;
  std::vector<double> v_, x_; ///< v_l, (2l+1) v_l^2 / (l (l+1))
  std::vector<double> zero_;  ///< w_l(0)
};

} // namespace cowgpu
