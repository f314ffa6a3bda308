// From a map that is harmonic but at one vertex to one that is harmonic on the whole sphere.
#pragma once

#include "host/map/laplacian.hpp"
#include "host/map/moebius.hpp"
#include "host/monitor.hpp"

#include <span>
#include <vector>

namespace cowgpu {

struct PolishReport {
  int steps = 0;
  /// sum over edges of w_ij |x_i - x_j|^2 / 2: near 4 pi, and less on coarse meshes, whose triangles are chords.
  double energy_before = 0, energy = 0;
  /// Squared size of the imbalance that is left, in the inverse metric, over the energy: its root is about the relative
  /// error of the positions.
  double decrement = 0;
};

/// From x to the map to the unit sphere that is harmonic everywhere, with its mean by area at zero: (L x)_i has no part
/// along the sphere but one that holds the map against Moebius transformations, which a mesh does not quite allow. That
/// part is taken proportional to the areas on the sphere. (Proportional to the areas on the surface, as minimising the
/// energy at fixed mean would have it, it draws shrunken limbs out into threads.) Steps of (L + M)^-1 times the
/// imbalance, M the mass matrix, each followed by centring; shorter ones where the imbalance does not fall (compare
/// X. Gu et al., IEEE Trans. Med. Imaging 23 (2004) 949).
///
/// `laplace` must be symmetric, `areas` as from vertex_areas. Throws Error(map_failed) if the decrement stays above
/// 1e-12, interrupted, and what centre() and SymmetricSolver throw.
PolishReport polish(const SparseMatrix& laplace, std::span<const Face> faces, std::span<const double> areas,
                    std::span<SpherePoint> x, Monitor& monitor = silent_monitor(), int most_steps = 400);

} // namespace cowgpu
