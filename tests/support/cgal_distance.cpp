#include "tests/support/cgal_distance.hpp"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <vector>

namespace cowgpu::test {
namespace {

using Plain = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Plain::Triangle_3>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Plain, CGAL::AABB_triangle_primitive<Plain, Triangles::const_iterator>>>;
using Exact = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Exact::Point_3>;

} // namespace

struct CgalTree::Trees {
  Triangles triangles;
  Tree tree;
  Mesh mesh;
  std::unique_ptr<CGAL::Side_of_triangle_mesh<Mesh, Exact>> side;
};

CgalTree::CgalTree(std::span<const Vec3> vertices, std::span<const Face> faces) : trees_(std::make_unique<Trees>()) {
  const auto point = [&](std::uint32_t v) { return Plain::Point_3(vertices[v].x(), vertices[v].y(), vertices[v].z()); };
  for (const Face& f : faces) trees_->triangles.emplace_back(point(f[0]), point(f[1]), point(f[2]));
  trees_->tree.insert(trees_->triangles.cbegin(), trees_->triangles.cend());
  trees_->tree.build();
  trees_->tree.accelerate_distance_queries();
  std::vector<Mesh::Vertex_index> index;
  for (const Vec3& v : vertices) index.push_back(trees_->mesh.add_vertex({v.x(), v.y(), v.z()}));
  for (const Face& f : faces) trees_->mesh.add_face(index[f[0]], index[f[1]], index[f[2]]);
  if (CGAL::is_closed(trees_->mesh))
    trees_->side = std::make_unique<CGAL::Side_of_triangle_mesh<Mesh, Exact>>(trees_->mesh);
}

CgalTree::~CgalTree() = default;

Vec3 CgalTree::closest(const Vec3& query) const {
  const Plain::Point_3 p = trees_->tree.closest_point({query.x(), query.y(), query.z()});
  return {p.x(), p.y(), p.z()};
}

int CgalTree::side(const Vec3& query) const {
  const CGAL::Bounded_side side = (*trees_->side)({query.x(), query.y(), query.z()});
  return side == CGAL::ON_BOUNDED_SIDE ? 1 : side == CGAL::ON_BOUNDARY ? 0 : -1;
}

} // namespace cowgpu::test
