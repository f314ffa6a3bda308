#include "host/plan/triangle_field.hpp"

#include "host/error.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::plan {

TriangleField::TriangleField(std::span<const Vec3> vertices, std::span<const Face> faces) : tree_({}, {}) {
  if (faces.empty()) throw Error(Fault::bad_argument, "the distance from a surface without faces");
  low_ = Vec3::Constant(std::numeric_limits<double>::infinity());
  high_ = -low_;
  frames_.reserve(faces.size());
  for (const Face& face : faces) {
    for (const std::uint32_t v : face) {
      if (v >= vertices.size())
        throw Error(Fault::bad_argument, fmt::format("a face names vertex {} of {}", v, vertices.size()));
      if (!vertices[v].allFinite())
        throw Error(Fault::bad_argument, fmt::format("vertex {} is not finite: it has no distance", v));
      low_ = low_.cwiseMin(vertices[v]);
      high_ = high_.cwiseMax(vertices[v]);
    }
    const Vec3 &a = vertices[face[0]], ab = vertices[face[1]] - a, ac = vertices[face[2]] - a;
    Frame f;
    f.a = a;
    f.length = ab.norm();
    const Vec3 cross = ab.cross(ac);
    const double doubled = cross.norm(), longest2 = std::max(ab.squaredNorm(), ac.squaredNorm());
    f.flat = !(doubled > 1e-15 * longest2) || f.length == 0;
    if (f.flat) {
      // Its edges alone: any frame that holds them. The longer of ab and ac spans it.
      const Vec3 along = f.length > 0 ? ab : ac;
      f.u = along.squaredNorm() > 0 ? Vec3(along.normalized()) : Vec3::UnitX();
      f.v = f.u.unitOrthogonal();
      f.n = Vec3::Zero();
    } else {
      f.u = ab / f.length;
      f.n = cross / doubled;
      f.v = f.n.cross(f.u);
    }
    f.cx = ac.dot(f.u);
    f.cy = f.flat ? 0 : ac.dot(f.v);
    f.ex = f.cx - f.length;
    f.ey = f.cy;
    const double ac2 = f.cx * f.cx + f.cy * f.cy, bc2 = f.ex * f.ex + f.ey * f.ey;
    f.per_ac = ac2 > 0 ? 1 / ac2 : 0;
    f.per_bc = bc2 > 0 ? 1 / bc2 : 0;
    frames_.push_back(f);
  }
  scale_ = (high_ - low_).norm();
  tree_ = Bvh(vertices, faces);
}

Foot TriangleField::foot(std::uint32_t face, const Vec3& p) const {
  const Frame& f = frames_[face];
  const Vec3 d = p - f.a;
  const double x = d.dot(f.u), y = d.dot(f.v);
  Foot foot;
  double qx = x, qy = y;
  if (f.flat || y < 0 || f.cx * y - f.cy * x > 0 || f.ex * y - f.ey * (x - f.length) < 0) {
    // The nearest of three segments, each with its parameter in [0, 1].
    double least = std::numeric_limits<double>::infinity();
    const auto look = [&](double s, double clamped, double px, double py) {
      const double here = (x - px) * (x - px) + (y - py) * (y - py);
      if (here >= least) return;
      least = here;
      qx = px;
      qy = py;
      foot.region = s == clamped ? Region::edge : Region::corner;
    };
    const double s = std::clamp(x, 0.0, f.length);
    look(x, s, s, 0);
    const double t = (x * f.cx + y * f.cy) * f.per_ac, tc = std::clamp(t, 0.0, 1.0);
    look(t, tc, tc * f.cx, tc * f.cy);
    const double w = ((x - f.length) * f.ex + y * f.ey) * f.per_bc, wc = std::clamp(w, 0.0, 1.0);
    look(w, wc, f.length + wc * f.ex, wc * f.ey);
  }
  foot.point = f.a + qx * f.u + qy * f.v;
  foot.distance = (p - foot.point).norm();
  return foot;
}

double TriangleField::distance2(std::uint32_t face, const Vec3& p) const {
  const double d = foot(face, p).distance;
  return d * d;
}

std::uint32_t TriangleField::nearest(const Vec3& x, std::uint32_t warm) const {
  // The one place where the flow asks the whole mesh.
  if (warm == none) return tree_.closest(x).face;
  const ClosestPoint found = tree_.closest(x, distance2(warm, x));
  return std::isfinite(found.distance2) ? found.face : warm;
}

int TriangleField::winding_number(const Vec3& x) const {
  if ((x.array() < low_.array()).any() || (x.array() > high_.array()).any()) return 0;
  Ray ray{x, Vec3(0.5377, 0.8339, -0.2588).normalized(), 4 * scale_};
  int winding = 0;
  double at = 0;
  for (int crossings = 0; crossings < 64; ++crossings) {
    RayHit hit;
    if (!tree_.first_hit(ray, hit)) return winding;
    const double edge = std::min({hit.u, hit.v, 1 - hit.u - hit.v}), slope = normal(hit.face).dot(ray.direction);
    if (edge < 1e-7 || std::abs(slope) < 1e-6) break;
    winding += slope > 0 ? 1 : -1;
    at += hit.t + 1e-11 * scale_;
    ray.origin = x + at * ray.direction;
  }
  return solid_angle_winding(x);
}

int TriangleField::solid_angle_winding(const Vec3& x) const {
  double sum = 0;
  for (const Frame& f : frames_) {
    const Vec3 a = f.a - x, b = a + f.length * f.u, c = a + f.cx * f.u + f.cy * f.v;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return int(std::lround(sum / (4 * std::numbers::pi)));
}

} // namespace cowgpu::plan
