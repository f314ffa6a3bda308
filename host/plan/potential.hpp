// The stage `potential`, what both paths share: the series of every derivative, where each point stands, and how many
// degrees it needs.
//
// With J_lm(x) = R^(l+1) Y_lm / r^(l+1), where derivatives of a J_lm are multiples of J_{l+1,m'} over R (the equations stand in
// host/reference/potential.hpp), V and each of its derivatives is
//   f(x) = sum over m = 0 ... top, l = m ... top of c_lm Re J_lm + s_lm Im J_lm,
// c and s formed once on the host; the trace of the second derivatives is 0, so that nine sets make all of them. The J_lm of
// a point come by recursion over l from J_mm, and these by recursion over m: with u = x/R, q = 1/u^2, (x', y', z') = u q
//   J_00 = sqrt(q / 4pi),  J_{m+1,m+1} = -sqrt((2m+3)/(2m+2)) (x' + i y') J_mm,
//   J_{l+1,m} = a z' J_lm - b q J_{l-1,m},   a = sqrt((2l+1)(2l+3) / ((l+1)^2 - m^2)),
//   b = a sqrt((l^2 - m^2) / ((2l-1)(2l+1))).
// Next to the axis J_lm answers an error of cos(theta) with l^2 times as much, so that z' is held in two doubles, whose
// quotient with sqrt(q) is right to 2^-64.
// Outside, |J_lm| is at most sqrt((2l+1)/4pi). J_mm underflows next to the axis: |J_mm| < 1e-307 means sin(theta) <
// 1e-307^(1/m), and order m counts from a degree near m / sin(theta) on; the least over m of that degree is 707 e = 1900.
#pragma once

#include "host/potential.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// Value; x, y, z; xx, xy, xz, yz, zz.
inline constexpr std::size_t potential_sets(Derivatives derivatives) {
  return derivatives == Derivatives::none ? 1 : derivatives == Derivatives::first ? 4 : 9;
}

/// The series of value and derivatives.
struct PotentialSeries {
  int lmax = 0;
  int top = 0; ///< lmax and the order of the derivatives
  std::size_t sets = 1;
  /// [m][l = m ... top][a, b, then c and s of each set]; a of l = top is the factor -sqrt((2m+3)/(2m+2)) instead.
  std::vector<double> table;
  /// [order of derivative][l]: bound of the terms of degree l where r = R.
  std::array<std::vector<double>, 3> bounds;

  std::size_t stride() const { return 2 + 2 * sets; }
};

/// Throws Error(bad_argument) for a degree out of range and moments that are not finite.
PotentialSeries potential_series(const PotentialProblem& problem);

/// The points, far ones first, in blocks that share a degree; filled up with points at infinity, where all is 0.
struct PotentialPoints {
  static constexpr std::size_t block = 64;

  std::vector<std::uint32_t> order;              ///< [i]: the problem's point that stands at i
  std::vector<double> x, y, z, z_rest, q, start; ///< x', y', z' in two parts, q, J_00; a multiple of `block`
  std::vector<int> tops;                         ///< for each block the degree up to which its points need the series
  std::size_t padded() const { return x.size(); }
  std::size_t blocks() const { return tops.size(); }
  /// Entries of the table that the points of block b look at.
  static double entries(int top) { return 0.5 * (top + 1) * (top + 2); }
};

/// Throws Error(point_inside) for a point nearer to the origin than R, naming it and by how much, Error(bad_argument) for
/// one that is not finite or farther than 1e150 R, and too_large for more than 2^31.
PotentialPoints potential_points(const PotentialProblem& problem, const PotentialSeries& series,
                                 std::span<const Vec3> points);

/// From the sums of the sets at each of the plan's points, [set][padded], to the field.
PotentialField potential_field(const PotentialProblem& problem, const PotentialPoints& points,
                               const std::vector<double>& sums);

/// Bytes of all three.
std::uint64_t potential_bytes(std::uint64_t points, int lmax, Derivatives derivatives);

} // namespace cowgpu::plan
