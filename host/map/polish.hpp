// From a map that is harmonic but at one vertex to one that is harmonic on the whole sphere.
#pragma once

#include "host/map/laplacian.hpp"
#include "host/map/moebius.hpp"

#include <span>
#include <vector>

namespace cowgpu {

struct PolishReport {
  int steps = 0;
  double energy_before = 0, energy = 0; ///< near 4 pi; less is left of coarse meshes, whose triangles are chords
  double decrement = 0; ///< what the next step would have taken off the energy, to first order, relative to it
};

/// Minimises the Dirichlet energy sum over edges of w_ij |x_i - x_j|^2 / 2 among maps to the unit sphere whose mean by
/// area is zero: descent along the gradient in the metric L + M, with backtracking; each step is followed by centring
/// (compare X. Gu et al., IEEE Trans. Med. Imaging 23 (2004) 949). `laplace` must be symmetric, `areas` as from
/// vertex_areas, x the map to start from. Throws Error(map_failed) if the decrement is above 1e-10 after `most_steps`
/// steps, and what centre() and SymmetricSolver throw.
PolishReport polish(const SparseMatrix& laplace, std::span<const Face> faces, std::span<const double> areas,
                    std::span<Direction> x, int most_steps = 400);

} // namespace cowgpu
