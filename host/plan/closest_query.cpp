#include "host/plan/closest_query.hpp"

#include "host/geometry/orientation.hpp"
#include "host/plan/closest_kernel.hpp"

#include <vector>

namespace cowgpu::plan {

std::optional<SurfacePoint> closest_point(const ClosestTree& tree, const Vec3& query, double below,
                                          std::uint32_t warm_face) {
  // The search counts by squares, whose rounding must not decide.
  const double wider = below + 1e-15 * (tree.size + query.cwiseAbs().maxCoeff());
  const std::uint32_t face =
      closest_single(tree, query, wider, warm_face == no_face ? no_face : tree.slot_of_face[warm_face]);
  if (face == no_face) return std::nullopt;
  const SurfacePoint found = tree.on_face(face, query);
  if (!(found.distance < below)) return std::nullopt;
  return found;
}

int winding_number(const ClosestTree& tree, const Vec3& query) {
  if ((query.array() < tree.low.array()).any() || (query.array() > tree.high.array()).any()) return 0;
  const bool up = query.z() > tree.centre.z();
  int winding = 0;
  thread_local std::vector<std::uint32_t> column;
  column.clear();
  column_faces(tree, query, up, column);
  for (const std::uint32_t face : column) {
    const Face& f = tree.faces[face];
    const Vec3 &a = tree.vertices[f[0]], &b = tree.vertices[f[1]], &c = tree.vertices[f[2]];
    winding += vertical_crossing(a, b, c, query, up);
  }
  return winding;
}

} // namespace cowgpu::plan
