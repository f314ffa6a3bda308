#include "host/mesh/triangle_surface.hpp"

#include "host/error.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace cowgpu {
namespace {

std::string called(const TriangleSurface& surface) {
  return surface.name.empty() ? "the surface" : surface.name;
}

void check_size(const TriangleSurface& surface, std::size_t size, const std::string& what) {
  if (size != surface.vertices.size())
    throw Error(Fault::bad_argument, fmt::format("{}: {} {} for {} vertices; there must be one each", called(surface),
                                                 size, what, surface.vertices.size()));
}

void check_name(const TriangleSurface& surface, const std::string& name, std::set<std::string>& taken) {
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
  if (name.empty() || !plain || !taken.insert(name).second)
    throw Error(Fault::bad_argument, fmt::format("{}: '{}' cannot name numbers at the vertices: letters, digits and "
                                                 "underscores can, and each name once",
                                                 called(surface), name));
}

} // namespace

std::vector<Vec3> vertex_normals(std::span<const Vec3> vertices, std::span<const Face> faces) {
  std::vector<Vec3> normals(vertices.size(), Vec3::Zero());
  for (const Face& face : faces) {
    const Vec3 side[3] = {vertices[face[1]] - vertices[face[0]], vertices[face[2]] - vertices[face[1]],
                          vertices[face[0]] - vertices[face[2]]};
    const Vec3 normal = side[0].cross(-side[2]);
    const double twice_area = normal.norm();
    if (!(twice_area > 0)) continue;
    for (int k = 0; k < 3; ++k)
      normals[face[std::size_t(k)]] += std::atan2(twice_area, -side[k].dot(side[(k + 2) % 3])) / twice_area * normal;
  }
  for (Vec3& normal : normals) {
    const double length = normal.norm();
    normal = length > 1e-9 ? Vec3(normal / length) : Vec3(0, 0, 1);
  }
  return normals;
}

void check(const TriangleSurface& surface) {
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
    for (const std::uint32_t v : surface.faces[f])
      if (v >= surface.vertices.size())
        throw Error(Fault::mesh_index_range, fmt::format("{}: face {} names vertex {}, but there are {} vertices",
                                                         called(surface), f, v, surface.vertices.size()));
  for (std::size_t v = 0; v < surface.vertices.size(); ++v)
    if (!surface.vertices[v].allFinite())
      throw Error(Fault::mesh_not_finite, fmt::format("{}: vertex {} has no finite coordinates", called(surface), v));
  if (!surface.normals.empty()) check_size(surface, surface.normals.size(), "normals");
  for (std::size_t v = 0; v < surface.normals.size(); ++v)
    if (!(std::abs(surface.normals[v].norm() - 1) <= 1e-6))
      throw Error(surface.normals[v].allFinite() ? Fault::bad_argument : Fault::mesh_not_finite,
                  fmt::format("{}: the normal of vertex {} is not a unit vector", called(surface), v));
  std::set<std::string> taken = {"x", "y", "z", "nx", "ny", "nz"};
  for (const VertexScalar& scalar : surface.scalars) {
    check_name(surface, scalar.name, taken);
    check_size(surface, scalar.values.size(), "values of " + scalar.name);
    for (std::size_t v = 0; v < scalar.values.size(); ++v)
      if (!std::isfinite(scalar.values[v]))
        throw Error(Fault::mesh_not_finite,
                    fmt::format("{}: {} at vertex {} is not finite", called(surface), scalar.name, v));
  }
}

} // namespace cowgpu
