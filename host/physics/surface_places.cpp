#include "host/physics/surface_places.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <utility>

namespace cowgpu::physics {
namespace {

// Zero where there is none: to divide by a length that has underflown would make a direction of rounding.
Vec3 direction(const Vec3& v) {
  const double length = v.stableNorm();
  return length > 0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

} // namespace

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).stableNorm(), a.dot(b));
}

SurfacePlaces face_places(const ClosedSurface& surface, double height) {
  SurfacePlaces found;
  found.place = ValuePlace::faces;
  const std::size_t count = surface.faces().size();
  found.at.reserve(count);
  found.normals.reserve(count);
  found.areas.reserve(count);
  for (const Face& face : surface.faces()) {
    const Vec3 &a = surface.vertices()[face[0]], &b = surface.vertices()[face[1]], &c = surface.vertices()[face[2]];
    const Vec3 area = (b - a).cross(c - a);
    found.normals.push_back(direction(area));
    found.areas.push_back(area.stableNorm() / 2);
    // From a corner, so that far from the origin the centroid stays in its face.
    found.at.emplace_back(a + ((b - a) + (c - a)) / 3 + height * found.normals.back());
  }
  return found;
}

SurfacePlaces vertex_places(const ClosedSurface& surface, double height) {
  SurfacePlaces found;
  found.place = ValuePlace::vertices;
  found.at = surface.vertices();
  found.normals.assign(found.at.size(), Vec3::Zero());
  found.areas.assign(found.at.size(), 0);
  for (const Face& face : surface.faces()) {
    const Vec3* x[3] = {&found.at[face[0]], &found.at[face[1]], &found.at[face[2]]};
    const Vec3 area = (*x[1] - *x[0]).cross(*x[2] - *x[0]), normal = direction(area);
    const double third = area.stableNorm() / 6;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &here = *x[k], &next = *x[(k + 1) % 3], &last = *x[(k + 2) % 3];
      found.normals[face[k]] += angle_between(next - here, last - here) * normal;
      found.areas[face[k]] += third;
    }
  }
  for (Vec3& normal : found.normals) normal = direction(normal);
  if (height != 0)
    for (std::size_t v = 0; v < found.at.size(); ++v) found.at[v] += height * found.normals[v];
  return found;
}

SurfacePlaces point_places(std::vector<Vec3> points) {
  SurfacePlaces found;
  found.place = ValuePlace::points;
  found.at = std::move(points);
  return found;
}

} // namespace cowgpu::physics
