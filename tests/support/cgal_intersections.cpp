#include "tests/support/cgal_intersections.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>

#include <array>
#include <utility>
#include <vector>

namespace cowgpu::test {

std::size_t cgal_self_intersections(std::span<const Vec3> vertices, std::span<const Face> faces) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : vertices) points.emplace_back(p.x(), p.y(), p.z());
  std::vector<std::array<std::size_t, 3>> triangles;
  for (const Face& f : faces) triangles.push_back({f[0], f[1], f[2]});
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  CGAL::Polygon_mesh_processing::triangle_soup_self_intersections(points, triangles, std::back_inserter(pairs));
  return pairs.size();
}

} // namespace cowgpu::test
