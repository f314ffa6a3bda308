// Balls inside a body.
#pragma once

#include "host/geometry/bvh.hpp"
#include "host/monitor.hpp"

#include <cstdint>
#include <optional>
#include <span>

namespace cowgpu {

/// Radius of the largest ball about a point inside the body: the distance from what bounds it. Nothing where the closed
/// surface does not wind about the point a positive number of times. `tree` is that of the faces, `boundary` that of
/// body_boundary(), which a surface that does not meet itself and whose shells hold no others is itself.
std::optional<double> inscribed_radius(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree,
                                       const Bvh& boundary, const Vec3& about);

/// A ball, and how large the largest can be.
struct LargestBall {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
  double bound = 0; ///< no ball in the body has a larger radius, but for rounding
};

/// Looks for the largest ball anywhere inside a closed surface: boxes are halved, those first where it may be largest, as a
/// distance changes no faster than its point moves, until bound <= 1.001 radius or `most` points were looked at (long
/// tubes and plates have many balls nearly as large). Radius 0 where no point inside was found. The trees are those of
/// inscribed_radius(). Throws Error(interrupted).
LargestBall largest_ball(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree,
                         const Bvh& boundary, Monitor& monitor, std::uint32_t most = 50000);

} // namespace cowgpu
