// The map that a level set of the distance gives: from a direction to the surface, straight back along the distance's ray.
#pragma once

#include "host/backend.hpp"
#include "host/sphere_grid.hpp"

#include <span>
#include <vector>

namespace cowgpu {

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

/// For every point of the grid the point on the ray from `origin` in its direction with d = T, d the signed distance, and of
/// it the closest point of the surface: x, y, z of F, [3][ring][longitude]. With the inflated body {d <= T} star-shaped about
/// the origin (host/flow/star_shape.hpp) there is one such point; else this is one of several.
///
/// The rays are those of the grid turned by `turn`, a rotation. By Newton's method in a bracket whose lower end has been seen
/// inside the level set and whose upper end outside: the sign of d decides, by the winding number, except where the surface is
/// nearer than T. A bracket that three steps do not halve is cut in its middle, so that every direction ends. `field` is the
/// surface's, closed, box [low, high].
///
/// Throws Error(bad_argument) for T <= 0, an origin that is not finite or not inside the level set, and what DistanceField
/// throws.
std::vector<double> level_set_positions(DistanceField& field, const Vec3& low, const Vec3& high, const Vec3& origin,
                                        double level, const SphereGrid& grid, Monitor& monitor,
                                        LevelSetReport* report = nullptr,
                                        const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity());

/// What single directions (unit vectors) meet, in their order.
struct LevelSetPoints {
  std::vector<Vec3> points;             ///< F
  std::vector<std::uint32_t> unsettled; ///< directions, by their number
};

/// As level_set_positions(); counts are added to the report's.
LevelSetPoints level_set_points(DistanceField& field, const Vec3& low, const Vec3& high, const Vec3& origin,
                                double level, std::span<const Vec3> directions, Monitor& monitor,
                                LevelSetReport* report = nullptr);

/// The six fields over the level set's map (host/spectrum/surface_fields.hpp), [field][ring][longitude], without the grid's
/// error at jumps: where a field differs from a neighbour's by more than the threshold, its value is the mean over
/// `parts` x `parts` directions of equal solid angle that fill the point's cell, of solid angle weight_i 2 pi / ring_length. The
/// cells' edges in colatitude are where the weights add up to 1 - cos theta. Angles are those of the turned directions.
struct JumpReport {
  std::uint64_t cells = 0, points = 0; ///< averaged; of the grid
  double unsettled_angle = 0;          ///< of the averaged cells' directions, as in LevelSetReport
};
std::vector<double> averaged_fields(DistanceField& field, const Vec3& low, const Vec3& high, const Vec3& origin,
                                    double level, const SphereGrid& grid, std::span<const double> positions,
                                    bool signed_dphi, int parts, Monitor& monitor, JumpReport* report = nullptr,
                                    const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity());

} // namespace cowgpu
