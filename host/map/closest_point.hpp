// For each direction the closest point of a mapped surface's chord triangles: how the paper's recipe looks a map up.
#pragma once

#include "host/monitor.hpp"
#include "host/sphere_grid.hpp"
#include "host/sphere_samples.hpp"
#include "host/types.hpp"

#include <span>

namespace cowgpu {

/// For every point of the grid the face, and the barycentric coordinates, of the point of the flat triangles between
/// `positions` (unit vectors, one per vertex) that is closest to its direction (SphereDirections). Of the faces that hold
/// the point the least index is taken, as DistanceField has it. Folded maps have an answer everywhere, and so have maps
/// with gaps; on a flip-free map the face differs from the ray's near the edges only. Of the counts in the result
/// faces_hit, flipped_faces, flat_faces and flipped_points are set.
///
/// By the verb `closest` on the CPU path. Throws Error(bad_argument) for no faces or a face that names no position, what
/// DistanceField throws, Error(interrupted).
SphereSamples closest_samples(std::span<const Vec3> positions, std::span<const Face> faces, const SphereGrid& grid,
                              Monitor& monitor);

} // namespace cowgpu
