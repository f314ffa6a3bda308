// The fast sum of the verb `polyhedron` on the CPU: faces far away by multipoles, those near by their closed forms.
//
// L. Greengard and V. Rokhlin, A new version of the fast multipole method for the Laplace equation in three dimensions, Acta
// Numerica 6 (1997) 229; with trees on faces and points, exact moments of faces, and an order for each pair of cells that its
// bound asks for (host/plan/polyhedron_pairs.hpp). The cost is in proportion to faces plus points.
#pragma once

#include "host/polyhedron.hpp"

#include <memory>

namespace cowgpu::cpu {

/// For a problem with a tolerance; takes the fast sum for any number of points (plan::fast_sum_pays() says when it is faster).
/// Trees, multipoles and patches are made by the first call of at(), and kept.
/// The tolerance is the gradient's; winding numbers are wrong by up to a thousand times it.
std::unique_ptr<PreparedPolyhedron> fast_polyhedron(const PolyhedronProblem& problem, unsigned threads);

/// The fast sum or the direct one, whichever takes less time for the points that are asked for.
std::unique_ptr<PreparedPolyhedron> faster_polyhedron(const PolyhedronProblem& problem, unsigned threads,
                                                      std::unique_ptr<PreparedPolyhedron> direct);

} // namespace cowgpu::cpu
