#include "host/figures/figures.hpp"

namespace cowgpu::figures {

PlanePoint in_plane(const Plane& plane, const Vec3& x) {
  return {plane.u().dot(x), plane.v().dot(x)};
}

std::vector<std::vector<PlanePoint>> section(const RawMesh& mesh, const Plane& plane) {
  std::vector<std::vector<PlanePoint>> lines;
  for (const CutLoop& loop : cut_by_plane(mesh.vertices, mesh.faces, plane)) {
    std::vector<PlanePoint>& line = lines.emplace_back();
    for (const Vec3& p : loop.points) line.push_back(in_plane(plane, p));
  }
  return lines;
}

} // namespace cowgpu::figures
