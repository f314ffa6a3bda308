// On which side of a plane a point lies, exactly.
#pragma once

#include "host/types.hpp"

namespace cowgpu {

/// The sign of det(a, b, c) = a . (b x c): 1, 0 or -1. On the unit sphere it is 1 if the triangle a, b, c runs
/// counter-clockwise seen from outside, -1 if clockwise, 0 if some great circle passes through all three corners.
///
/// Exact for all finite doubles, subnormal ones included: a forward error bound decides nearly always, and where it
/// cannot, the six products are added as integers (as in J. R. Shewchuk, Discrete Comput. Geom. 18 (1997) 305, but with
/// a fixed-point sum in place of expansions, so that nothing underflows). Antisymmetric in its arguments. Expects the
/// rounding and subnormal numbers of IEEE 754 (not inside FlushDenormals).
int orientation(const Vec3& a, const Vec3& b, const Vec3& c);

/// The same without the error bound: always by integers, some six times slower.
int orientation_exact(const Vec3& a, const Vec3& b, const Vec3& c);

/// The sign of det(a - p, b - p, c - p), exact in the same way: 1 if p is on the side of the plane through a, b, c from
/// which they run clockwise (behind a face), -1 if it is in front, 0 if it is in the plane. Differences must not overflow.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

/// The same without the error bound.
int side_of_plane_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

/// The sign of the doubled area of the triangle a, b, c seen along the axis from its positive end (0 x, 1 y, 2 z), exact: 1 if
/// it runs counter-clockwise, 0 if it is a line or a point there.
int orientation_along(int axis, const Vec3& a, const Vec3& b, const Vec3& c);

/// What a face adds to the winding number about p along the vertical ray from p, upwards or downwards: 1, 0 or -1, exact. p
/// counts as moved by an infinitesimal along x and by its square along y, so that no ray meets an edge, and a p in the
/// face's plane as behind the ray's start: the face is not met. The sum over a closed surface's faces is the winding
/// number.
int vertical_crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, bool up);

} // namespace cowgpu
