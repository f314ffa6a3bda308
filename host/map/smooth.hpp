// The map to the sphere that smoothing makes.
#pragma once

#include "host/map/sphere_map.hpp"
#include "host/monitor.hpp"

namespace cowgpu {

struct SmoothOptions {
  /// Of the first implicit step, in units of the surface's area (which each step restores); it doubles with every step
  /// up to largest_step.
  double first_step = 1e-3, largest_step = 1;
  /// Ready when a step moves the surface by this part of its mean radius, Moebius transformations aside (root mean
  /// square by area): those go on for ever on a mesh, and centring takes them out.
  double settled = 1e-4;
  /// Then radii may differ by this part of their mean (root mean square by area). A mesh ends as round as its size allows.
  double roundness = 0.3;
  int most_steps = 200;
  bool align = true; ///< as in HarmonicOptions
};

/// Conformalised mean-curvature flow (M. Kazhdan, J. Solomon, M. Ben-Chen, Computer Graphics Forum 31 (2012) 1745): steps
/// (M_t + s L) x' = M_t x with the cotangent Laplacian L of the surface as it was and the mass matrix M_t of linear
/// elements on the surface as it is, scaled back to the area it had and moved to its centre of mass, until the surface
/// is a sphere; then projected onto the unit sphere, centred by a Moebius transformation and rotated. The limit is conformal as the harmonic map is; the
/// orientation is kept, and triangles may flip where cotangent weights are negative.
///
/// Throws Error: map_topology unless the surface is one sphere; bad_argument for options that are not positive;
/// map_failed where it has not settled after most_steps or is not round then, or where weights, systems or centring fail;
/// interrupted, between steps.
SphereMap smooth_map(const ManifoldSurface& surface, const SmoothOptions& options = {},
                     Monitor& monitor = silent_monitor());

} // namespace cowgpu
