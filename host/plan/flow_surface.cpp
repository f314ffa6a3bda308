#include "host/plan/flow_surface.hpp"

#include "host/error.hpp"
#include "host/geometry/morton.hpp"
#include "host/plan/closest_kernel.hpp"
#include "host/plan/closest_query.hpp"
#include "host/plan/flow_steps.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cowgpu::plan {

FlowSurface::FlowSurface(std::span<const Vec3> vertices, std::span<const Face> faces)
    : tree_(vertices, faces), diagonal_((tree_.high - tree_.low).norm()) {
  if (!tree_.closed)
    throw Error(Fault::mesh_open, "the flow off a surface that is not closed: it has no inside. Close its edges");
  frames_.reserve(faces.size());
  normals_.reserve(faces.size());
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    frames_.push_back(tree_.frames[tree_.slot_of_face[f]]);
    const Vec3 &a = vertices[faces[f][0]], ab = vertices[faces[f][1]] - a, ac = vertices[faces[f][2]] - a;
    normals_.push_back(ab.cross(ac).stableNormalized());
  }
}

Foot FlowSurface::foot(std::uint32_t face, const Vec3& p) const {
  const TriangleFrame<double>& t = frames_[face];
  const Eigen::Map<const Vec3> a(t.a), u(t.u), v(t.v);
  const Vec3 r = p - a;
  const double x = dot<double>(u, r), y = dot<double>(v, r);
  Foot foot;
  double qx = x, qy = y;
  foot.inside = y > 0 && t.cx * y - t.cy * x < 0 && t.ex * y - t.ey * (x - t.length) > 0;
  if (!foot.inside) {
    const auto square = [](double s) { return s * s; };
    qx = std::clamp(x, 0.0, t.length);
    qy = 0;
    double least = square(x - qx) + square(y);
    const double sc = std::clamp((x * t.cx + y * t.cy) * t.c_inverse, 0.0, 1.0);
    const double c2 = square(x - sc * t.cx) + square(y - sc * t.cy);
    if (c2 < least) least = c2, qx = sc * t.cx, qy = sc * t.cy;
    const double xb = x - t.length, se = std::clamp((xb * t.ex + y * t.ey) * t.e_inverse, 0.0, 1.0);
    if (square(xb - se * t.ex) + square(y - se * t.ey) < least) qx = t.length + se * t.ex, qy = se * t.ey;
  }
  foot.point = a + qx * u + qy * v;
  foot.distance = norm<double>(p - foot.point);
  return foot;
}

std::uint32_t FlowSurface::nearest(const Vec3& x, std::uint32_t warm) const {
  return closest_single(tree_, x, std::numeric_limits<double>::infinity(),
                        warm == no_face ? no_face : tree_.slot_of_face[warm]);
}

int FlowSurface::winding_number(const Vec3& x) const {
  return plan::winding_number(tree_, x);
}

std::vector<std::uint32_t> FlowSurface::order(std::span<const Vec3> points, unsigned threads) const {
  return morton_order(points, tree_.low, tree_.high, threads);
}

} // namespace cowgpu::plan
