// Input and output of the verb `potential`.
#pragma once

#include "host/multipoles.hpp"
#include "host/types.hpp"

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

namespace cowgpu {

/// Up to here no order that counts underflows, at any place outside (host/plan/potential.hpp).
inline constexpr int largest_potential_degree = 1536;

/// Of PotentialProblem::cut_off: an eighth of a double's rounding unit.
inline constexpr double default_potential_cut_off = 0x1p-56;

/// In R: a point on the sphere that rounding has moved inside is outside.
inline constexpr double nearest_potential = 1 - 1e-9;

/// What is asked for: V alone, its gradient too, its second derivatives too.
enum class Derivatives { none = 0, first = 1, second = 2 };

/// Input of the verb `potential`: V(x) = integral of density(y) / |x - y| outside a body, by its moments.
struct PotentialProblem {
  const Multipoles& moments;
  std::span<const Vec3> points; ///< seen from the moments' origin, their length unit; no nearer to it than R (to 1e-9)
  int lmax = 0;                 ///< 0 ... min(moments.lmax, largest_potential_degree)
  Derivatives derivatives = Derivatives::second;
  /// The degrees left out far away add up to at most so much of the bound of all of them; 0: leave out none.
  double cut_off = default_potential_cut_off;
};

/// xx, xy, xz, yy, yz, zz.
using SymmetricTensor = std::array<double, 6>;

/// V in mass over length, its gradient over its square, its second derivatives over its cube; one entry a point, in their
/// order; empty where not asked for.
struct PotentialField {
  std::vector<double> value;
  std::vector<Vec3> gradient;
  std::vector<SymmetricTensor> hessian;
};

} // namespace cowgpu
