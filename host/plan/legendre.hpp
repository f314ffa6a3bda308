// What both paths of the Legendre stage share: one sequence for both parities, and where each ring starts it.
//
// After Ishioka (J. Meteor. Soc. Japan 96 (2018) 241). With e_l = sqrt((l^2 - m^2) / (4 l^2 - 1)), l = m + 2 k and
// x = cos theta, the orthonormal associated Legendre functions (Condon-Shortley phase) of one order m are
//   P_{l+1} = x alpha_k lambda_k,   P_l = e_{l+1} alpha_k lambda_k + e_l alpha_{k-1} lambda_{k-1},
//   lambda_{k+1} = (a_k x^2 + b_k) lambda_k + lambda_{k-1},   lambda_{-1} = 0,
//   lambda_0 = P_mm = (-1)^m sqrt(1/4pi) prod_{q=1..m} sqrt((2q+1)/2q) sin^m theta,
//   alpha_0 = 1/e_{m+1},  alpha_1 = e_{m+1} / (e_{m+2} e_{m+3}),  alpha_{k+1} = s_k / (e_{l+2} e_{l+3} alpha_k),
//   a_k = s_k alpha_k^2,  b_k = -a_k (e_{l+1}^2 + e_{l+2}^2),  s_k = +1 for even k, -1 for odd k.
// A field's part of order m on the rings theta and pi - theta is E + O and E - O with
//   E = sum_k lambda_k qe_k,             qe_k = alpha_k (e_{l+1} a_l + e_{l+2} a_{l+2}),
//   O = x sum_k lambda_k qo_k,           qo_k = alpha_k a_{l+1},
// and in the other direction, with f = (N + S) and g = x (N - S) of the rings' Fourier coefficients times their weights,
//   re_k = sum over pairs of rings of lambda_k f,  ro_k = sum of lambda_k g,
//   a_{l+1} = alpha_k ro_k,  a_l = e_{l+1} alpha_k re_k + e_l alpha_{k-1} re_{k-1}.
//
// Near the poles x^2 rounded to double would cost l^2 times that rounding; there the recurrence takes -sin^2 theta in
// place of x^2 and a_k + b_k in place of b_k, which is the same number with its digits kept.
//
// A ring starts the recurrence where |P_l| first exceeds `significant`, from two stored values: nothing underflows, and
// what is left out near the poles is below 1e-30.
#pragma once

#include "host/sphere_grid.hpp"

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// Pairs of rings in a block: what vectors and layouts are made of.
inline constexpr int block_pairs = 8;
/// Steps k are padded to a multiple of this, with coefficients 0.
inline constexpr int step_multiple = 8;
/// |P_lm| below which a ring is left out.
inline constexpr double significant = 1e-30;

/// Recurrence coefficients and rings of a transform. Pairs of rings are sorted from the poles to the equator.
struct Legendre {
  int lmax = 0;
  int pairs = 0;        ///< number of pairs of rings
  int blocks = 0;       ///< number of blocks of block_pairs pairs; arrays over pairs have blocks * block_pairs entries
  int polar_blocks = 0; ///< the first blocks, which take -sin^2 theta

  std::vector<int> north;     ///< ring north of the equator, or on it; -1 in the padding
  std::vector<int> south;     ///< its mirror image, -1 where the grid has none
  std::vector<double> x;      ///< cos theta of the northern ring; 0 in the padding
  std::vector<double> t;      ///< x^2, in polar blocks -sin^2 theta; 0 in the padding
  std::vector<double> weight; ///< quadrature weight times 2 pi / ring_length, of both rings; 0 in the padding
  std::vector<long double> sine;

  std::vector<std::size_t> offset; ///< where each order's steps begin in a, b, b_polar, alpha; lmax + 2 entries
  std::vector<double> a, b, b_polar, alpha;
  std::vector<std::size_t> e_offset; ///< begin of each order's e_l, l = m, m + 1, ..., to l = m + 2 padded_steps(m) + 1
  std::vector<double> e;

  /// Steps k with m + 2 k <= lmax.
  int steps(int m) const { return (lmax - m) / 2 + 1; }
  int padded_steps(int m) const { return (steps(m) + step_multiple - 1) / step_multiple * step_multiple; }
};

/// Plan for `grid`, lmax <= grid.lmax. `threads` 0: all.
Legendre legendre(const SphereGrid& grid, int lmax, unsigned threads = 0);

/// A plan without rings: the coefficients of the recurrence only, for any lmax up to largest_grid_degree.
Legendre recurrence(int lmax, unsigned threads = 0);

/// Start of the recurrence, per group of consecutive orders and block of pairs.
struct Seeds {
  static constexpr std::uint32_t never = 0xffffffffu;

  int orders = 1;  ///< orders a group: m / orders
  int segment = 8; ///< steps a segment
  int groups = 0;
  /// [group][block]: the first segment in which some |P_lm| of the group exceeds `significant`, or an earlier one;
  /// never if there is none. Does not increase from the poles to the equator.
  std::vector<std::uint32_t> start;
  /// [m][block][2][block_pairs]: lambda_{k-1} and lambda_k for k = start * segment. Exactly 0 in the padding and where a
  /// value is too small to matter at any degree.
  std::vector<double> values;
};

Seeds seeds(const Legendre& plan, int orders, int segment, unsigned threads = 0);

/// q[k][4] = re qe_k, im qe_k, re qo_k, im qo_k for k < padded_steps(m), stride between steps in doubles; `coefficients`
/// are a_lm, l = m ... lmax. Imaginary parts count as 0 for m = 0.
void prepare_synthesis(const Legendre& plan, int m, std::span<const std::complex<double>> coefficients, double* q,
                       std::size_t stride);

/// From r[k][4] = re and im of re_k, re and im of ro_k, k < steps(m), to a_lm, l = m ... lmax.
void finish_analysis(const Legendre& plan, int m, const double* r, std::size_t stride,
                     std::span<std::complex<double>> coefficients);

/// Steps (k of one order on one pair of rings) that the recurrence runs from its starts on, padding included.
double active_steps(const Legendre& plan, const Seeds& seeds);

} // namespace cowgpu::plan
