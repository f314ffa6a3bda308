// A map to the sphere that keeps every triangle the right way round and stretches little: limbs stay visible on it.
//
// E. Praun, H. Hoppe, Spherical parametrization and remeshing, SIGGRAPH 2003: the surface is simplified to a tetrahedron,
// that is put on the sphere, and the vertices return one by one, each into the kernel of its ring and followed by a
// relaxation of the stretch (stretch_energy.hpp). It is not conformal.
#pragma once

#include "host/map/sphere_map.hpp"
#include "host/monitor.hpp"

namespace cowgpu {

struct StretchOptions {
  /// Relaxations of all vertices, one after the other, once all are back; fewer if nothing moves any more.
  unsigned sweeps = 30;
  /// Weight of the stretch from the surface to the sphere, at least 0; 0.1 makes the shear less extreme.
  double lambda = 0;
  /// Go on to a minimum of the energy, by Newton's method on all vertices.
  bool converge = false;
};

/// How good a map is in the sense that the stretch map minimises.
struct StretchMeasure {
  /// The energy over 4 pi on a surface of area 4 pi: the mean squared stretch from the sphere to the surface. A map that
  /// keeps the shape of every triangle has the mean of s^2 / h^2, s the factor of lengths and h the distance of the
  /// triangle's plane from the sphere's centre, since the area on the sphere is det / 2 (stretch_energy.hpp): for an isometry it tends
  /// to 1 from above as triangles shrink (with lambda to 1 + lambda), and the icosahedron inscribed in the sphere has
  /// 2.08. Infinite if a triangle is not positively oriented.
  double energy = 0;
  /// Root of the sum over vertices of the squared gradient of `energy` along the sphere, in 1/radian. NaN if infinite.
  double gradient = 0;
};

/// Maps a surface of genus 0. The result is the same bit for bit on every run, and depends on the shape, not on the order
/// of vertices and faces (see canonical_surface.hpp). It is turned so that the sum of a_i (X_i . (V_i - c)) is largest:
/// a_i a third of the area of the faces at vertex i, c the mean of the V_i by a_i. Notes say the energy, the sweeps or
/// Newton steps and the gradient. Every triangle is certified: its exact orientation is positive.
///
/// Throws Error with map_topology (several components, or holes through the body), mesh_no_volume (no area), map_failed
/// (a vertex without a place, or a triangle that rounding turned over), bad_argument (lambda), interrupted.
SphereMap stretch_map(const ManifoldSurface& surface, const StretchOptions& options, Monitor& monitor);

/// Of any map of that surface to the sphere, positions as in SphereMap.
StretchMeasure measure_stretch(const ManifoldSurface& surface, const SphereMap& map, double lambda = 0);

} // namespace cowgpu
