#include "host/mesh/winding.hpp"

#include "host/geometry/orientation.hpp"

namespace cowgpu {

void crossings(const Bvh& tree, std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& point,
               std::vector<Crossing>& found) {
  found.clear();
  const std::span<const Bvh::Node> nodes = tree.nodes();
  if (nodes.empty()) return;
  const bool up = point.z() > nodes[0].low.z() / 2 + nodes[0].high.z() / 2;
  std::uint32_t stack[Bvh::deepest + 1] = {0};
  int waiting = 1;
  while (waiting) {
    const std::uint32_t at = stack[--waiting];
    const Bvh::Node& node = nodes[at];
    if (point.x() < node.low.x() || point.x() > node.high.x() || point.y() < node.low.y() ||
        point.y() > node.high.y() || (up ? point.z() > node.high.z() : point.z() < node.low.z()))
      continue;
    if (node.count == 0) {
      stack[waiting++] = node.first;
      stack[waiting++] = at + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const std::uint32_t face = tree.faces()[i];
      const Face& f = faces[face];
      const int sign = vertical_crossing(vertices[f[0]], vertices[f[1]], vertices[f[2]], point, up);
      if (sign != 0) found.push_back({face, sign});
    }
  }
}

int winding_number(const Bvh& tree, std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& point) {
  thread_local std::vector<Crossing> found;
  crossings(tree, vertices, faces, point, found);
  int winding = 0;
  for (const Crossing& crossing : found) winding += crossing.sign;
  return winding;
}

} // namespace cowgpu
