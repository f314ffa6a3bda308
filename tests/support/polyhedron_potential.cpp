#include "tests/support/polyhedron_potential.hpp"

#include <Eigen/Geometry>

#include <array>
#include <cmath>

namespace cowgpu::test {
namespace {

using Real = long double;

// Equation 7: L_e = ln((a + b + e) / (a + b - e)), a and b the distances of the edge's ends, e its length.
Real edge_factor(Real a, Real b, Real e) {
  return std::log((a + b + e) / (a + b - e));
}

// Equation 6: the solid angle of the face as seen from the point.
Real solid_angle(const std::array<LongVec3, 3>& r, const std::array<Real, 3>& d) {
  const Real y = r[0].dot(r[1].cross(r[2]));
  const Real x = d[0] * d[1] * d[2] + d[0] * r[1].dot(r[2]) + d[1] * r[2].dot(r[0]) + d[2] * r[0].dot(r[1]);
  return 2 * std::atan2(y, x);
}

} // namespace

PolyhedronGravity polyhedron_gravity(const RawMesh& mesh, const LongVec3& at) {
  PolyhedronGravity sum;
  for (const auto& face : mesh.faces) {
    std::array<LongVec3, 3> r;
    std::array<Real, 3> d{};
    for (std::size_t c = 0; c < 3; ++c) {
      r[c] = mesh.vertices[face[c]].cast<Real>() - at;
      d[c] = r[c].norm();
    }
    const LongVec3 area = (r[1] - r[0]).cross(r[2] - r[0]);
    if (!(area.norm() > 0)) continue; // a face without area has no gravity
    const LongVec3 normal = area.normalized();
    const Real height = normal.dot(r[0]), angle = solid_angle(r, d);
    sum.potential -= height * height * angle / 2;
    sum.acceleration += normal * (height * angle);
    sum.laplacian -= angle;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t next = (c + 1) % 3;
      const LongVec3 edge = r[next] - r[c];
      const Real length = edge.norm();
      const LongVec3 outward = (edge / length).cross(normal); // in the face's plane
      const Real factor = edge_factor(d[c], d[next], length), across = outward.dot(r[c]);
      sum.potential += height * across * factor / 2;
      sum.acceleration -= normal * (across * factor);
    }
  }
  return sum;
}

} // namespace cowgpu::test
