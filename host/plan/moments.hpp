// What both fast paths of the stage `moments` do before and after the arithmetic.
//
// Mathematics. With x the position divided by R and U_lm = g_lm S_lm, g_lm = s^m l! / (sqrt((2l+1)/4pi)
// sqrt((l-m)!(l+m)!)), a directional derivative of solid harmonics needs no coefficients but the direction:
//
//   (d.D U)_m = d_z U_m + (d_x - i d_y)/(2s) U_{m+1} - s (d_x + i d_y)/2 U_{m-1},    U_{-m} = (-1)^m s^{-2m} conj U_m
//
// and the moments of the tetrahedron (0, A, B, C), det = det(A, B, C), follow from three chained recursions
//
//   v_l = (C.D) v_{l-1}        v_0 = 1
//   e_l = (B.D) e_{l-1} + det v_l,    t_l = (A.D) t_{l-1} + e_l,     e_0 = t_0 = det
//   Q_lm / R^(l+3) = t_l[m] / (g_lm (l+1)(l+2)(l+3))
//
// because the integral of the l-th power of a linear form over a tetrahedron is det l!/(l+3)! times the complete
// homogeneous symmetric polynomial of its values at A, B, C (Lasserre and Avrachenkov 2001, "The multi-dimensional
// version of int_a^b x^p dx", Theorem 2.1), and S_lm(x) = (x.grad)^l S_lm / l!. v_l[m] is a real number times
// exp(i m phi_C). Two triangles ABC, ABD that share an edge share e and t and need two rows v.
//
// Range. For |x| <= 1, |S_lm| <= sqrt((2l+1)/4pi), so |U_lm| <= s^m l!/sqrt((l-m)!(l+m)!). For s = 1 that is at most 1 and
// falls to about 2^-l at m = l; for s = 2 it is 1 at both ends and at most 2^(0.322 l), at m = 0.6 l. The rows start at
// 2^start_exponent instead of 1, chosen so that neither overflows to degree 4096 and that whatever is above 1e-150 of a
// degree's bound stays normal. Below that, rows of vertices near the z axis pass through denormals, which the paths count
// as zero (host/flush_denormals.hpp).
//
// Determinants. Both paths take det from geometry/determinant.hpp, which computes it again in more bits where it cancels: of
// thin bodies it would else be the largest error. The vertices a, b, c less the origin, over R, are rounded to doubles;
// that moves t_l by some l units in its last place, as the recursion itself does.
//
// Cut-off. On the triangle's tetrahedron |S_lm| <= r^l sqrt((2l+1)/4pi), r its largest vertex radius, and by homogeneity
// the integral of (|x|/r)^l over it is at most 3/(l+3) of its volume |det|/6. So a set D of triangles adds at most
// sqrt((2l+1)/4pi)/(l+3) sum_D |det|/2 r^l to any Q_lm. Per degree the smallest groups are left out while their sum stays
// below cut_off times the sum over all triangles: the error is then at most cut_off B_l with B_l of degree_bound().
#pragma once

#include "host/moment_problem.hpp"
#include "host/multipoles.hpp"
#include "host/run_report.hpp"

#include <cstdint>
#include <vector>

namespace cowgpu::plan {

/// Two triangles (a, b, c) and (b, a, d) sharing the edge a-b, or one triangle with det_d = 0. Coordinates are relative to
/// the origin, divided by R.
struct TrianglePair {
  Vec3 a, b, c, d;
  double det_c = 0, det_d = 0;
  double radius = 0; ///< largest vertex radius, <= 1 up to rounding
};

/// The work of one verb, ready for SIMD groups of `lanes` pairs each.
struct Moments {
  int lmax = 0;
  int lanes = 1;
  int column_scale = 1;            ///< s above: 1 up to degree 1024, 2 beyond
  int start_exponent = 0;          ///< rows start at 2^start_exponent
  std::vector<TrianglePair> pairs; ///< by decreasing radius; padded with empty pairs to a multiple of lanes
  std::vector<int> last_degree;    ///< degree at which the rows of each group stop; non-negative, <= lmax
  double sum_of_dets = 0;          ///< over all triangles, as sum_of_determinants() has it
  std::uint64_t pair_count = 0;    ///< without the padding
  double elements = 0;             ///< sum over pairs of (L+1)(L+2)/2, L the group's last degree
  double full_elements = 0;        ///< the same with L = lmax

  std::size_t groups() const { return last_degree.size(); }
};

/// Pairs, scales, sorts and cuts off. Throws Error(bad_argument) for lmax outside [0, largest_degree], a radius that is
/// not positive and finite, or a vertex outside it.
Moments moments(const MomentProblem& problem, int lanes);

/// Numbers of a pair as SIMD lanes want them: [group][input][lane], groups in the given order. The inputs are those of
/// shaders/moments.h: directions a and b (x, y over twice the column scale; z), distance from the z axis (over twice the
/// scale) and z of c and d, cosine and sine of their longitudes, det_c, det_d.
inline constexpr std::size_t inputs = 16;
void lane_inputs(const Moments& plan, std::size_t group, double* to);
std::vector<double> lane_inputs(const Moments& plan, std::span<const std::uint32_t> order);

/// What a path reports of a run by this plan; kernel times are its own to add.
RunReport report(const Moments& plan, double setup_seconds, double seconds);

/// Bound of the bytes moments() allocates: 304 a face and 8 a vertex.
std::uint64_t bytes(const MomentProblem& problem);

/// Turns the sums over all triangles of t_l[m] 2^start_exponent, real and imaginary parts interleaved, sorted by
/// l, then m, into multipoles.
Multipoles finish(const MomentProblem& problem, const Moments& plan, std::span<const double> sums);

/// B_l = |density| R^3 sqrt((2l+1)/4pi)/(l+3) sum |det|/2 r^l for l = 0 ... lmax, in the units of Q_lm / R^l, r and det
/// taken after division by R: an a-priori bound of |Q_lm / R^l|, and of the norm of degree l over all orders.
std::vector<double> degree_bound(const MomentProblem& problem);

/// Of each degree, in the same units.
struct DegreeSums {
  std::vector<double> bound; ///< B_l
  std::vector<double> root;  ///< the triangles' terms of B_l added as the root of the sum of their squares
  std::vector<double>
      left_out; ///< bound of what problem.cut_off leaves out of the norm of the degree, at most cut_off B_l
};

/// Triangles are left out by groups that add up to at most cut_off B_l, so that each of them has no more; left_out adds the
/// terms of all such triangles. Of few large triangles it is 0.
DegreeSums degree_sums(const MomentProblem& problem);

} // namespace cowgpu::plan
