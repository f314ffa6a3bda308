// How a body comes to rest on level ground: y is up.
//
// Quasi-static rolling: with the outward direction n pointing down in the body's frame and r_v = v - b, the barycentre b is
// h(n) = max_v n.r_v above the ground, and the body rolls down the steepest way, without slipping or turning about the vertical.
// A patch of contact that b is not over does not hold: the body tips over the edge or the corner of the patch nearest to the
// point below b, which then touches alone. That way is a great circle of directions, until the next vertex touches: each
// roll is one pass over the vertices, exact up to rounding, and no convex hull is made of which a few facets would be used. It
// ends on a facet of the hull whose inside b is over: a least value of h. All rolls together are in general not the least
// rotation that brings this facet down.
//
// It ends: every roll lowers b, as b is beyond the edge or corner, so that no attitude comes twice, and an edge is rolled over
// once at most. Where rounding leads over an edge a second time, the facets on both sides of it are alike to 1e-10 of the size,
// and the body rests there.
#pragma once

#include "host/monitor.hpp"
#include "host/types.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace cowgpu::physics {

/// One roll about a corner or an edge that touches the ground, until the next vertex touches.
struct Roll {
  std::vector<std::size_t> over; ///< the corner, or both ends of the edge: indices of vertices
  double angle = 0;              ///< radians
  double before = 0, after = 0;  ///< height of b above the ground
};

/// How the body as modelled is turned to rest.
struct Attitude {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity(); ///< all rolls, one after the other
  double angle = 0;                                       ///< angle of that rotation, radians
  double least_angle = 0; ///< angle of the least rotation that brings the same side down
  double heading = 0;     ///< what turns that into `rotation`: radians about +y
  std::vector<Roll> rolls;
  bool balanced = false; ///< stood on a corner or an edge, b right above: it was let fall to the right, or off the edge
};

/// Rolls a body down from the attitude as modelled. Throws Error(cannot_stand) where the barycentre comes down to the ground:
/// it lies outside the convex hull of the vertices then (parts of negative mass), or they are flat; interrupted.
Attitude settle(std::span<const Vec3> vertices, const Vec3& barycentre, const Monitor& monitor = silent_monitor());

/// Where a body touches the ground.
struct Contact {
  double ground = 0;                 ///< y of the ground: the lowest vertex
  std::vector<std::size_t> vertices; ///< indices of those no more than the tolerance above it
  std::vector<Vec3> support;         ///< where they are
  std::vector<Vec3>
      patch; ///< corners of their convex hull seen from above, counter-clockwise about y; 1 or 2 if it has no area
  double margin = 0; ///< distance of the barycentre's foot from the patch's border, below 0 outside
};

/// Of a body in its attitude. `tolerance` is at least 1e-9 of the largest distance of a vertex from b.
Contact contact(std::span<const Vec3> vertices, const Vec3& barycentre, double tolerance);

} // namespace cowgpu::physics
