#include "host/plan/closest_texels.hpp"

#include "host/geometry/bvh.hpp"

#include <bit>
#include <cmath>

namespace cowgpu::plan {
namespace {

constexpr float beyond_all = 3e18F; // as in the tree: beyond every bound, and its square finite

std::uint32_t word(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

void add_child(const ClosestTree& tree, const Bvh::Node& child, std::uint32_t index, std::vector<std::uint32_t>& to) {
  const auto low = tree.local(child.low), high = tree.local(child.high);
  for (const float x : low) to.push_back(word(std::nextafter(x, -beyond_all)));
  to.push_back(child.count > 0 ? child.first : index);
  for (const float x : high) to.push_back(word(std::nextafter(x, beyond_all)));
  to.push_back(child.count);
}

} // namespace

ClosestTexels::ClosestTexels(const ClosestTree& tree) {
  const Bvh bvh(tree.vertices, tree.faces);
  const auto boxes = bvh.nodes();
  // Inner nodes alone are numbered.
  std::vector<std::uint32_t> number(boxes.size());
  std::uint32_t inner = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (boxes[i].count == 0) number[i] = inner++;
  nodes.reserve(16 * std::size_t(inner) + 16);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (boxes[i].count == 0)
      for (const std::size_t child : {i + 1, std::size_t(boxes[i].first)})
        add_child(tree, boxes[child], number[child], nodes);
  if (inner == 0) {
    add_child(tree, boxes[0], 0, nodes);
    for (int k = 0; k < 8; ++k) nodes.push_back(k % 4 == 3 ? 0 : word(beyond_all));
  }

  triangles.reserve(20 * tree.faces.size());
  slots.reserve(tree.faces.size());
  for (const std::uint32_t face : bvh.faces()) {
    const std::uint32_t slot = tree.slot_of_face[face];
    slots.push_back(slot);
    const TriangleFrame<float>& t = tree.single_frames[slot];
    const float* axes[3] = {t.u, t.v, t.n};
    for (int axis = 0; axis < 3; ++axis) {
      for (int c = 0; c < 3; ++c) triangles.push_back(word(axes[axis][c]));
      triangles.push_back(word(t.a[axis]));
    }
    for (const float x : {t.length, t.cx, t.cy, t.c_inverse, t.ex, t.ey, t.e_inverse, 0.0F})
      triangles.push_back(word(x));
  }
}

} // namespace cowgpu::plan
