// The feet of a smooth body: which of the vertices that touch the ground stand for one point of contact.
#pragma once

#include "host/types.hpp"

#include <span>
#include <vector>

namespace cowgpu::physics {

/// A point of contact, spread over the triangles about it: how far its vertices reach sideways.
struct Foot {
  double left = 0, right = 0; ///< least and largest z
};

/// Groups `touching`, indices of vertices that touch the ground at the height `ground` (y up). Two are of one foot where at most three
/// edges lead from one to the other, or where they are near (a tenth of `size`) and a way over the surface between them
/// rises by no more than 0.02 of their distance: next to the poles of a grid edges are short. Sagittas of a surface that is
/// resolved are less; a dent between two feet is more. The order is that of each foot's first vertex.
std::vector<Foot> feet(std::span<const Vec3> vertices, std::span<const Face> faces,
                       std::span<const std::size_t> touching, double ground, double size);

} // namespace cowgpu::physics
