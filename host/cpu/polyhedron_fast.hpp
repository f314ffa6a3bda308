// The fast sum of the verb `polyhedron` on the CPU (host/plan/polyhedron_fast.hpp): threads take tasks of points.
#pragma once

#include "host/polyhedron.hpp"

#include <memory>

namespace cowgpu::cpu {

/// For a problem with a tolerance; takes the fast sum for any number of points (plan::fast_sum_pays() says when it is faster).
/// Trees, multipoles and patches are made by the first call of at(), and kept.
/// The tolerance is the gradient's; winding numbers are wrong by up to a thousand times it.
std::unique_ptr<PreparedPolyhedron> fast_polyhedron(const PolyhedronProblem& problem, unsigned threads);

} // namespace cowgpu::cpu
