// Moments by a second recursion, and how large the triangles' shares in them are.
#pragma once

#include "host/moment_problem.hpp"
#include "host/monitor.hpp"
#include "host/multipoles.hpp"

#include <vector>

namespace cowgpu {

struct MomentTerms {
  Multipoles sum; ///< Q_lm / R^l
  /// A_l of each degree, with |t_l| the norm over all orders of a triangle's share in Q_lm / R^l, and s_l what it would be
  /// were nothing cancelled within the triangle:
  ///   A_l^2 = sum over triangles of |t_l|^2 + (s_l / (8 + l))^2,  s_l = sqrt((2 l + 1) / 4 pi) density / R^l times
  ///   the integral of (x |A| + y |B| + z |C|)^l >= r^l over the triangle's tetrahedron, x, y, z barycentric.
  std::vector<double> root;
};

/// The moments of `problem` in double precision by the recursion of host/reference/moments.hpp: orthonormal harmonics with
/// the square roots of their gradients, no pairs, no cut-off but where a degree's bound proves a triangle to be below 1e-18 of
/// it. Backend::moments() of every kind works in another basis, by pairs and in another order, so that what both agree on is
/// right to rounding. Triangles are the lanes of SIMD vectors. Runs on up to `threads` threads (0: all); the bits do not
/// depend on them. Throws Error(interrupted).
MomentTerms moment_terms(const MomentProblem& problem, unsigned threads, const Monitor& monitor);

/// Bound of the bytes moment_terms() allocates, its result included.
std::uint64_t moment_terms_bytes(const MomentProblem& problem);

} // namespace cowgpu
