// The convex hull of points, decided by exact signs.
#pragma once

#include "host/types.hpp"

#include <span>
#include <vector>

namespace cowgpu {

/// The hull's triangles, counter-clockwise seen from outside, as indices of `points`; together a closed surface. A facet of
/// more than three corners is several triangles. Of equal points one is taken. Empty where all points lie in one plane.
/// Quickhull (Barber, Dobkin and Huhdanpaa 1996, ACM Trans. Math. Softw. 22, 469) with side_of_plane(), which is exact, so
/// that no facet needs a thickness. Expects finite points.
std::vector<Face> convex_hull(std::span<const Vec3> points);

/// The solid angle of every point's normal cone, the directions in which it is the farthest of all: 2 pi less the sum of the
/// hull's angles at it (Gauss and Bonnet), 0 for points that are no corner of the hull. Their sum is 4 pi.
std::vector<double> normal_cone_solid_angles(std::span<const Vec3> points, std::span<const Face> hull);

} // namespace cowgpu
