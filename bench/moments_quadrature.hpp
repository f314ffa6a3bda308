// The rival of the benchmark: mass multipoles as a physicist would script them, by a lattice of midpoints.
#pragma once

#include "host/backend.hpp"

#include <cstdint>

namespace cowgpu::bench {

/// Moments by quadrature, and what they took.
struct LatticeMoments {
  Multipoles moments;
  double spacing = 0;        ///< side of a cell, mesh length units
  std::uint64_t columns = 0; ///< lattice columns along z
  std::uint64_t cells = 0;   ///< cells whose midpoint is inside
  double seconds = 0;        ///< wall time
};

/// Q_lm / R^l of `problem` (its cut_off is not used) as the sum of density r^l Y_lm h^3 over the cells, of side h =
/// `spacing`, of a cubic lattice centred on the body's bounding box whose midpoint is inside the body; a cell counts as
/// often as the surface winds round its midpoint. Inside and outside are told by the crossings of each lattice column
/// with the surface. Y_lm comes from the usual recursion of orthonormal associated Legendre functions in double
/// precision; exp(i m phi) is evaluated once a column. On `threads` threads (0: all).
///
/// Throws Error(bad_argument) for a spacing that is not positive or gives more than 2^20 cells along an axis, and
/// Error(check_failed) if a column enters the body more often than it leaves it.
LatticeMoments lattice_moments(const MomentProblem& problem, double spacing, unsigned threads);

} // namespace cowgpu::bench
