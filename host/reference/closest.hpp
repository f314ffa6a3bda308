// The stage `closest`, plain: every face for every query. The oracle of its paths, templated on the number.
//
// A face's closest point is the foot on its plane if that lies inside, else the best of those of its three edges. The
// winding number is the sum of the faces' solid angles over 4 pi (A. Van Oosterom and J. Strackee, IEEE Trans. Biomed.
// Eng. 30 (1983) 125).
#pragma once

#include "host/distance_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace cowgpu::reference {

template <class T>
using Point = std::array<T, 3>;

template <class T>
Point<T> point_of(const Vec3& p) {
  return {T(p.x()), T(p.y()), T(p.z())};
}
template <class T>
Point<T> minus(const Point<T>& a, const Point<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
T dot(const Point<T>& a, const Point<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
Point<T> cross(const Point<T>& a, const Point<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class T>
struct Closest {
  T distance2 = T(-1);          ///< squared; -1: none so far
  Point<T> offset{};            ///< vector from the query to the point
  std::uint32_t face = no_face; ///< the nearest face; the least of several at the same distance
  SurfaceFeature feature;
};

/// Takes the face's closest point if it is nearer than `best`.
template <class T>
void take_face(std::span<const Vec3> vertices, std::span<const Face> faces, std::uint32_t f, const Point<T>& p,
               Closest<T>& best) {
  // Everything relative to the query.
  const auto take = [&](const Point<T>& q, const SurfaceFeature& feature) {
    const T d2 = dot(q, q);
    if (best.face == no_face || d2 < best.distance2) best = {d2, q, f, feature};
  };
  Point<T> corner[3];
  for (std::size_t k = 0; k < 3; ++k) corner[k] = minus(point_of<T>(vertices[faces[f][k]]), p);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = faces[f][k], w = faces[f][(k + 1) % 3];
    const Point<T>&a = corner[k], e = minus(corner[(k + 1) % 3], a);
    const T length2 = dot(e, e), along = -dot(a, e);
    if (length2 == 0 || along <= 0)
      take(a, {SurfaceFeature::Kind::vertex, v, v});
    else if (along < length2)
      take({a[0] + along / length2 * e[0], a[1] + along / length2 * e[1], a[2] + along / length2 * e[2]},
           {SurfaceFeature::Kind::edge, std::min(v, w), std::max(v, w)});
  }
  const Point<T> n = cross(minus(corner[1], corner[0]), minus(corner[2], corner[0]));
  const T n2 = dot(n, n);
  if (n2 == 0) return;
  const T height = dot(corner[0], n) / n2;
  const Point<T> q = {height * n[0], height * n[1], height * n[2]};
  for (std::size_t k = 0; k < 3; ++k)
    if (dot(cross(minus(corner[(k + 1) % 3], corner[k]), minus(q, corner[k])), n) < 0) return;
  take(q, {SurfaceFeature::Kind::face, f, f});
}

template <class T>
Closest<T> closest(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& query) {
  Closest<T> best;
  const Point<T> p = point_of<T>(query);
  for (std::uint32_t f = 0; f < faces.size(); ++f) take_face(vertices, faces, f, p, best);
  return best;
}

/// Not rounded; an integer for a closed surface, but on the surface itself.
template <class T>
T winding_number(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& query) {
  using std::atan2;
  using std::sqrt;
  const Point<T> p = point_of<T>(query);
  T sum = 0; // sum of half the solid angles
  for (const Face& face : faces) {
    Point<T> r[3];
    T length[3];
    for (std::size_t k = 0; k < 3; ++k) {
      r[k] = minus(point_of<T>(vertices[face[k]]), p);
      length[k] = sqrt(dot(r[k], r[k]));
    }
    const T volume = dot(r[0], cross(r[1], r[2]));
    const T rest = length[0] * length[1] * length[2] + dot(r[0], r[1]) * length[2] + dot(r[1], r[2]) * length[0] +
                   dot(r[2], r[0]) * length[1];
    if (volume != 0) sum += atan2(volume, rest);
  }
  return sum / (8 * atan2(T(1), T(1)));
}

} // namespace cowgpu::reference
