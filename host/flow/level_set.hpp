// The map that a level set of the distance gives: from a direction to the surface, straight back along the distance's ray.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/geometry.hpp"
#include "host/sphere_grid.hpp"

#include <span>
#include <vector>

namespace cowgpu {

/// The surface where the signed distance d from a closed surface is `level`, seen from `origin`.
struct LevelSet {
  DistanceField& field; ///< distances from the surface
  Box box;              ///< bounding box of the surface
  Vec3 origin;
  double level; ///< T > 0
};

/// How a level set was met.
struct LevelSetReport {
  std::uint64_t queries = 0;   ///< closest points asked for
  double largest_residual = 0; ///< of |d - T|
  double least_slope = 1; ///< of the direction along the gradient of d: 0 or less where the level set is not a graph
  /// Directions whose place on the ray is known no better than to 1e-9 of the diagonal (far from the coordinates' zero, to
  /// 1e-14 of them), and on a grid the solid angle that they stand for.
  std::uint64_t unsettled = 0;
  double unsettled_angle = 0;
  double place_error = 0,
         angle_error = 0; ///< of the settled ones' places at most, and of F's directions: by gap, slope and rounding
  double seconds = 0;
};

/// For every point of the grid the point on the ray from the origin in its direction with d = T, and F, the surface's closest
/// point to that: its x, y, z, [3][ring][longitude]. With the inflated body {d <= T} star-shaped about the origin
/// (host/flow/star_shape.hpp) there is one such point; else this is one of several.
///
/// The rays are those of the grid turned by `turn`, a rotation. By Newton's method in a bracket whose lower end has been seen
/// inside the level set and whose upper end outside: the sign of d decides, by the winding number, except where the surface is
/// nearer than T. A bracket that three steps do not halve is cut in its middle, so that every direction ends.
///
/// Throws Error(bad_argument) for T <= 0, an origin that is not finite or not inside the level set, and what DistanceField
/// throws.
std::vector<double> level_set_positions(const LevelSet& set, const SphereGrid& grid, Monitor& monitor,
                                        LevelSetReport* report = nullptr,
                                        const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity());

/// What single directions (unit vectors) meet, in their order.
struct LevelSetPoints {
  std::vector<Vec3> points;             ///< F
  std::vector<std::uint32_t> unsettled; ///< directions, by their number
};

/// As level_set_positions(); counts are added to the report's.
LevelSetPoints level_set_points(const LevelSet& set, std::span<const Vec3> directions, Monitor& monitor,
                                LevelSetReport* report = nullptr);

} // namespace cowgpu
