// CGAL's search for self-intersections, to compare with. Its package is under the GPL; nothing of this is linked into the
// program.
#pragma once

#include "host/types.hpp"

#include <cstddef>
#include <span>

namespace cowgpu::test {

/// Pairs of triangles with more in common than the vertices and edges they share by number: crossing, overlapping or
/// touching. Faces must have area, edges two
/// faces that run them in opposite directions.
std::size_t cgal_self_intersections(std::span<const Vec3> vertices, std::span<const Face> faces);

} // namespace cowgpu::test
