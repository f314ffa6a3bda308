// The surface of an inflated body: all points at one distance from it.
#pragma once

#include "host/distance_field.hpp"
#include "host/mesh/triangle_surface.hpp"

namespace cowgpu {

struct LevelSurfaceReport {
  double cell = 0;             ///< side of the lattice's cubes
  std::uint64_t cubes = 0;     ///< that were cut into tetrahedra
  std::uint64_t queries = 0;   ///< closest points asked for
  double largest_residual = 0; ///< largest |d - level| over the vertices
  /// By points scattered in the cubes that the level may pass: the volume within the level and what chance leaves of it (three
  /// standard deviations), and of that the volume which corners do not show, in cubes with all of them on one side.
  double sampled_volume = 0, sampled_chance = 0, missed = 0;
  double seconds = 0;
};

/// The level set d = level > 0 of the signed distance from a closed surface in the box [low, high], as triangles seen
/// counter-clockwise from where d is more. By marching tetrahedra, six a cube (Freudenthal's, which agree from cube to
/// cube), on a lattice of `cells` cubes along the longest side of the box grown by the level: a closed 2-manifold whatever
/// the topology, shells inside the body's hollows included. Each vertex is moved onto d = level to 1e-12 of the diagonal
/// along the gradient of d, which is its normal; where two sheets of the level set meet in a crease no vertex need lie on
/// the crease, so the surface is right to O(cell^2) on sheets and to O(cell) beside creases. What is thinner than a cell
/// may be missed. Only cubes that the level can pass are looked at.
///
/// Throws Error(bad_argument) for a level that is not finite and above 0 or cells outside 4 ... 1024, too_large beyond 2^31
/// vertices, and what DistanceField throws. Memory: about 100 bytes a cube that is cut.
TriangleSurface level_surface(DistanceField& field, const Vec3& low, const Vec3& high, double level, int cells,
                              Monitor& monitor, LevelSurfaceReport* report = nullptr);

/// What the volume and the area of such a surface are off by.
struct LevelSurfaceError {
  double volume = 0, area = 0; ///< sums over the triangles, before errors
  double volume_error = 0, area_error = 0;
};

/// Estimated with the surfaces of lattices of half and a quarter of the cubes: one and a half times the change to the one of half,
/// or a quarter of the change before it, whichever is more. In volume no less than the distance to the sampled volume and what
/// chance leaves of that; in area no less than the same part of it, and what corners do not show counts three times over the level,
/// as no inflated body has more area for its volume (M. Kneser, Arch. Math. 6 (1955) 382). Takes a third of what the surface
/// took. Throws what level_surface() throws.
LevelSurfaceError level_surface_error(DistanceField& field, const Vec3& low, const Vec3& high, double level, int cells,
                                      const TriangleSurface& surface, const LevelSurfaceReport& report,
                                      Monitor& monitor);

} // namespace cowgpu
