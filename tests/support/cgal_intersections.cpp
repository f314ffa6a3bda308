#include "tests/support/cgal_intersections.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <utility>
#include <vector>

namespace cowgpu::test {

std::size_t cgal_self_intersections(std::span<const Vec3> vertices, std::span<const Face> faces) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  Mesh mesh;
  std::vector<Mesh::Vertex_index> index;
  for (const Vec3& v : vertices) index.push_back(mesh.add_vertex({v.x(), v.y(), v.z()}));
  for (const Face& f : faces) mesh.add_face(index[f[0]], index[f[1]], index[f[2]]);
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(pairs));
  return pairs.size();
}

} // namespace cowgpu::test
