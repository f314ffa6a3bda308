// The tree of the stage `closest` as a device reads it: binary, for lanes that each walk their own way
// (shaders/closest.h).
#pragma once

#include "host/plan/closest_tree.hpp"

#include <cstdint>
#include <vector>

namespace cowgpu::plan {

struct ClosestTexels {
  /// Boxes in the tree's units, rounded outwards. 64 bytes a node, about half a node a face, 80 a face and four.
  explicit ClosestTexels(const ClosestTree& tree);

  std::vector<std::uint32_t> nodes;     ///< 16 words a node: both children's boxes, indices and counts
  std::vector<std::uint32_t> triangles; ///< 20 words a triangle: its frame
  std::vector<std::uint32_t> slots;     ///< the triangles' slots in the tree
};

} // namespace cowgpu::plan
