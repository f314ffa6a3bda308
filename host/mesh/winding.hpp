// How often a surface winds about a point, by the faces above or below it.
#pragma once

#include "host/geometry/bvh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu {

/// A face that a vertical ray crosses, and what that adds to the winding number.
struct Crossing {
  std::uint32_t face;
  int sign;
};

/// The faces that the vertical ray from the point crosses, upwards from the upper half of the box, else downwards, in no
/// particular order; by exact signs (vertical_crossing()). `tree` is that of these faces.
void crossings(const Bvh& tree, std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& point,
               std::vector<Crossing>& found);

/// The winding number of a closed surface about a point; about points of the surface that of either side.
int winding_number(const Bvh& tree, std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& point);

} // namespace cowgpu
