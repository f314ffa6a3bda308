// How large the error of each degree of a body's moments is, estimated from the computation itself.
//
// Rounding. Every triangle's share t in a degree is rounded on its own, so that errors add like the squares' root. With
// u = 2^-53, N triangles, |.| the norm over all orders of a degree, and
//
//   A_l = sqrt(sum over triangles of |t_l|^2 + (s_l / (8 + l))^2)
//
// with s_l the share were nothing cancelled within the triangle (host/moment_terms.hpp; of a regular tetrahedron's faces
// t_2 = 0), the estimate of the error of degree l >= 1 is
//
//   E_l = 2 u sqrt( ((8 + l + sqrt(N)/4) A_l)^2 + (6 |Q_l|)^2 ) + left_out_l
//
// with 8 for the steps that every degree takes, l for the recursion and for the vertices, which are moved to the origin, divided
// by R and rounded, sqrt(N)/4 for the sum, 6 for normalisation and the result's own rounding, and 2 for chance; left_out_l is
// what the cut-off left out. A_l is far above |Q_l| where terms cancel: on hollow bodies, about far origins, in degrees that
// a symmetry forbids. Determinants need no term, because they are computed to the last place (geometry/determinant.hpp), and with them the
// mass: E_0 = 4 u |Q_0| + 2^-98 B_0, B_l the bound of plan::degree_bound(). Of several parts E_l^2 adds, before the parts
// cancel. Moments about a far origin are moved there, and their errors with them (host/mass/translate.hpp).
#pragma once

#include "host/moment_terms.hpp"

#include <span>
#include <string>
#include <vector>

namespace cowgpu {

/// What the estimate takes of one problem, each degree in the units of Q_lm / R^l.
struct RoundingTerms {
  std::vector<double> root;     ///< A_l
  std::vector<double> norm;     ///< |Q_l|
  std::vector<double> bound;    ///< B_l
  std::vector<double> left_out; ///< by the cut-off
  double triangles = 0;         ///< N
};

/// Of each degree, in the units of Q_lm / R^l.
struct ErrorEstimate {
  std::vector<double> error; ///< E_l
  std::vector<double> norm;  ///< |Q_l| of the sum of all problems
  std::vector<double> bound; ///< B_l, summed over the problems
};

/// E_l of one problem.
std::vector<double> error_estimate(const RoundingTerms& terms);

/// A_l of a problem of which `sample` is a part, by plan::DegreeSums::root of all triangles and of the sample (the
/// sample's about its own radius): twice the sample's share of its bound, and at most the bound.
std::vector<double> root_by_sample(std::span<const double> sample_root, std::span<const double> sample_bound,
                                   std::span<const double> bound);

/// The estimate in sentences, one each for the degrees known to 1e-6 of their norm or better, those known worse, and those of
/// which nothing but rounding is left (E_l at least half of the norm). Degrees come as "0 to 64", "1, 3, 5 ... 63".
std::vector<std::string> sentences(const ErrorEstimate& estimate);

/// Degrees in words: runs of three and more as "3 to 8" or, every other degree, "1, 3, 5 ... 63"; at most six pieces.
std::string degree_list(std::span<const int> degrees);

/// The largest error over its norm of the degrees that are known to half of their norm, and where; 0 and -1 without any.
struct WorstDegree {
  double relative = 0;
  int degree = -1;
};
WorstDegree worst_known_degree(const ErrorEstimate& estimate);

} // namespace cowgpu
