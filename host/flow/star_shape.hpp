// When a body that is blown up becomes star-shaped.
#pragma once

#include "host/backend.hpp"

#include <span>

namespace cowgpu {

/// The least t for which the inflated body {d <= t} is star-shaped about an origin, between two bounds. Adding a ball keeps
/// a star-shaped set so: it is star-shaped for every t above, and for none below `lower`.
struct StarShapeTime {
  double lower = 0;      ///< 0 if the body is star-shaped as it is
  double upper = 0;      ///< proven
  bool given_up = false; ///< the bounds are farther apart than asked for
  /// The witness of `lower`: at q + t n, for every t just below it, the inflated body's surface looks away from the origin.
  Vec3 point = Vec3::Zero();  ///< q, on the surface
  Vec3 normal = Vec3::Zero(); ///< n, a unit vector of its normal cone
  Vec3 place = Vec3::Zero();  ///< q + lower n
  std::uint64_t regions = 0;  ///< parts of the surface and its normals that were looked at
  std::uint64_t queries = 0;  ///< closest points asked for
};

/// With R(q, n) the radius of the largest ball outside the body that touches it at q from the side of n,
///
///   t* = sup over surface points q and their normals n of min(R(q, n), (origin - q) . n):
///
/// q + t n lies on the inflated body's surface, with normal n, as long as t <= R, and sees the origin from behind as long as
/// t < (origin - q) . n. The lower bound is the largest value met. The upper one, within `tolerance` of it (a length), is
/// proven by bisecting faces, edges with their arcs of normals and vertices with their cones of normals: R(q, n) >= L means
/// that q + L n is at least L from the surface, distances change no faster than the place, so one query rules out a whole
/// neighbourhood. Rounding is allowed for by 1e-12 of the diagonal.
///
/// Where the origin is behind the plane of every face, by exact signs, the body is star-shaped as it is: 0 and `tolerance`,
/// without a search.
///
/// Some 1e5 to 1e6 queries where the supremum is met at points. Where it is met all along an edge, as between two parallel
/// boxes, they grow like length / tolerance. So the tolerance goes down from the diagonal by tens, and the search is given up
/// once it would look at more than 2e7 regions in all: the upper bound is then that of the tolerance before, proven all the same (that of
/// the first needs no search: no surface point is farther from the origin).
///
/// The surface must be a closed manifold (ManifoldSurface). Throws Error(bad_argument) for an origin that is not finite or a tolerance below 1e-9 of
/// the diagonal, what DistanceField throws, interrupted.
StarShapeTime star_shape_time(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& origin,
                              double tolerance, Backend& backend, Monitor& monitor);

/// The tolerance that commands ask for: 1e-6 of the bounding box's diagonal; where the body is star-shaped as it is, 1e-9 of it, so
/// that the level set at the upper bound is the surface itself. Far from the coordinates' zero no less than 2^-47 of them, which
/// distances resolve.
double usual_star_shape_tolerance(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& origin);

} // namespace cowgpu
