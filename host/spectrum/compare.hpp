// How far two sets of moments are apart, degree by degree.
#pragma once

#include "host/coefficients.hpp"

#include <span>
#include <vector>

namespace cowgpu {

/// Error of one set of coefficients against another.
struct DegreeErrors {
  std::vector<double> relative; ///< of each degree, l = 0 ... lmax
  double worst = 0;             ///< the largest of them; NaN if anything is not a number
  int worst_degree = 0;
  double weighed = 0; ///< the largest of relative / max(1, bound / (15 norm)): what is held against expected_error()
};

/// For each degree sqrt(sum_m |a - b|^2) (all orders, negative ones included) over the norm of degree l of b; where that
/// norm is below 1e-3 of `bound[l]`, and for the dipole always (about the centre of mass it is zero by definition), over
/// bound[l], the a-priori bound of host/plan/moments.hpp. A degree where all three vanish has error 0. Both sets must be
/// of one lmax, origin and radius.
DegreeErrors compare(const Coefficients& a, const Coefficients& b, std::span<const double> bound);

/// The same against coefficients in extended precision, real and imaginary parts interleaved.
DegreeErrors compare(const Coefficients& a, std::span<const long double> b, std::span<const double> bound);

/// The bound DegreeErrors::weighed of a correct path stays within: 3e-14 to degree 512, growing in proportion to the degree
/// beyond (1.2e-13 at 2048), because the rounding of a vertex's coordinates enters a degree l with the factor l. In other
/// words a degree passes if its error is within 3e-14 of its norm or within 2e-15 of its a-priori bound: rounding goes with
/// the terms, and nearly round bodies or far origins have degrees whose terms cancel (1.2e-15 of the bound was seen).
double expected_error(int lmax);

} // namespace cowgpu
