// The map to the sphere that smoothing makes.
#pragma once

#include "host/map/sphere_map.hpp"

namespace cowgpu {

struct SmoothOptions {
  /// Of the first implicit step, in units of the surface's area (which each step restores); it doubles with every step
  /// up to largest_step.
  double first_step = 1e-3, largest_step = 0.1;
  /// Round enough: largest |radius / mean radius - 1| over the vertices, about the centre of mass of the area.
  double roundness = 1e-9;
  int most_steps = 500;
  bool align = true; ///< as in HarmonicOptions
};

/// Conformalised mean-curvature flow (M. Kazhdan, J. Solomon, M. Ben-Chen, Computer Graphics Forum 31 (2012) 1745): steps
/// (M_t + s L) x' = M_t x with the cotangent Laplacian L of the surface as it was and the mass matrix M_t of linear
/// elements on the surface as it is, scaled back to the area it had and moved to its centre of mass, until the surface
/// is a sphere; then centred by a Moebius transformation and rotated. The limit is conformal as the harmonic map is; the
/// orientation is kept, and triangles may flip where cotangent weights are negative.
///
/// Throws Error: map_topology unless the surface is one sphere; bad_argument for options that are not positive;
/// map_failed where it is not round after most_steps, or where weights, systems or centring fail.
SphereMap smooth_map(const ManifoldSurface& surface, const SmoothOptions& options = {});

} // namespace cowgpu
