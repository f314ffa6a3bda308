// The casting of rays of the stage `render`, plain: every face for every ray. The oracle of its paths, templated on the
// number.
#pragma once

#include "host/types.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace cowgpu::reference {

template <class T>
struct RayHit {
  static constexpr std::uint32_t nothing = 0xffffffffU;
  std::uint32_t face = nothing; ///< the face hit; the least of several at the same t
  T t{}, u{}, v{};              ///< hit = origin + t direction = (1 - u - v) a + u b + v c
};

/// The first triangle along origin + t direction with 0 <= t <= limit; edges and corners belong to triangles. By Cramer's
/// rule on origin + t d = a + u (b - a) + v (c - a).
template <class T>
RayHit<T> first_hit(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& origin,
                    const Vec3& direction, double limit) {
  using Point = std::array<T, 3>;
  const auto minus = [](const Vec3& p, const Vec3& q) {
    return Point{T(p.x()) - T(q.x()), T(p.y()) - T(q.y()), T(p.z()) - T(q.z())};
  };
  const auto det = [](const Point& a, const Point& b, const Point& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  };
  const Point back = {-T(direction.x()), -T(direction.y()), -T(direction.z())};
  RayHit<T> best;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    const Vec3& a = vertices[faces[f][0]];
    const Point ab = minus(vertices[faces[f][1]], a), ac = minus(vertices[faces[f][2]], a), s = minus(origin, a);
    const T whole = det(back, ab, ac);
    if (whole == 0) continue;
    const T t = det(s, ab, ac) / whole, u = det(back, s, ac) / whole, v = det(back, ab, s) / whole;
    if (u < 0 || v < 0 || u + v > 1 || t < 0 || t > T(limit)) continue;
    if (best.face == RayHit<T>::nothing || t < best.t) best = {f, t, u, v};
  }
  return best;
}

} // namespace cowgpu::reference
