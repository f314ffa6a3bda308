// A map with folds, each sheet with its sign: a sum that is well defined where the map is not one to one.
#pragma once

#include "host/map/sphere_map.hpp"
#include "host/spectrum/expand_surface.hpp"

#include <span>

namespace cowgpu {

struct SheetReport {
  std::uint64_t faces = 0, flipped_faces = 0, flat_faces = 0; ///< mapped triangles; flipped: det(a, b, c) < 0
  std::uint64_t points = 0, folded_points = 0;                ///< grid points; folded: in more than one triangle
  std::uint32_t most_sheets = 0;                              ///< over one point
  /// Smallest and largest sum of signs over one point: the degree of the map, the same everywhere, 1 for a flow off a body
  /// with one outer shell that keeps clear of the origin.
  double least_degree = 0, largest_degree = 0;
};

/// The six fields (host/spectrum/surface_fields.hpp) on the grid, [field][ring][longitude]: at a direction the sum of f(F)
/// over the spherical triangles that hold it, times the sign of det(a, b, c), F interpolated linearly in the flat triangle
/// of the mesh. A point on an edge counts by half for both triangles, one at a corner by the angles; signs are exact.
/// `positions` are unit vectors, one per vertex. Throws Error(bad_argument) for sizes that do not fit or a face that names no
/// vertex, interrupted.
std::vector<double> sheet_fields(std::span<const Vec3> vertices, std::span<const Face> faces,
                                 std::span<const Vec3> positions, const SphereGrid& grid, const Vec3& origin,
                                 bool signed_dphi, Monitor& monitor, SheetReport* report = nullptr);

} // namespace cowgpu
