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
  std::uint64_t unsettled = 0; ///< directions left with |d - T| above 1e-12 of the diagonal
  double seconds = 0;
};

/// For every point of the grid the point on the ray from `origin` in its direction with d = T, outside the body, and of it
/// the closest point of the surface: x, y, z of F, [3][ring][longitude]. With the inflated body {d <= T} star-shaped about
/// the origin (host/flow/star_shape.hpp) there is one such point; else this is one of several.
///
/// By Newton's method, kept between bounds: from outside no step may be longer than to where d could be T, from inside none
/// shorter than to the far side of the ball of radius T about the closest point. `field` is the surface's, box [low, high].
/// Throws Error(bad_argument) for T <= 0 or an origin not finite, and what DistanceField throws.
std::vector<double> level_set_positions(DistanceField& field, const Vec3& low, const Vec3& high, const Vec3& origin,
                                        double level, const SphereGrid& grid, Monitor& monitor,
                                        LevelSetReport* report = nullptr);

/// The same for single directions (unit vectors), their F in their order; counts are added to the report's.
std::vector<Vec3> level_set_points(DistanceField& field, const Vec3& low, const Vec3& high, const Vec3& origin,
                                   double level, std::span<const Vec3> directions, Monitor& monitor,
                                   LevelSetReport* report = nullptr);

/// The six fields over the level set's map (host/spectrum/surface_fields.hpp), [field][ring][longitude], without the grid's
/// error at jumps: where a field differs from a neighbour's by more than the threshold, its value is the mean over
/// `parts` x `parts` directions of equal solid angle that fill the point's cell, of solid angle weight_i 2 pi / ring_length. The
/// cells' edges in colatitude are where the weights add up to 1 - cos theta.
struct JumpReport {
  std::uint64_t cells = 0, points = 0; ///< averaged; of the grid
};
std::vector<double> averaged_fields(DistanceField& field, const Vec3& low, const Vec3& high, const Vec3& origin,
                                    double level, const SphereGrid& grid, std::span<const double> positions,
                                    bool signed_dphi, int parts, Monitor& monitor, JumpReport* report = nullptr);

} // namespace cowgpu
