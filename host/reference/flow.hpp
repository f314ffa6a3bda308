// The distance flow as plain scalar code, the oracle: every face is looked at, every corner, edge and triangle of a hull, and
// steps are small and all of one length. It shares no code with the paths (host/plan/flow_steps.hpp, host/plan/flow_path.hpp).
#pragma once

#include <Eigen/Geometry>
#include <Eigen/QR>

#include <array>
#include <cstdint>
#include <span>

namespace cowgpu::reference {

template <class T>
using Vector = Eigen::Matrix<T, 3, 1>;

/// The point of least norm in the convex hull of unit vectors, zero where the hull holds the origin: the least of what the
/// lines and planes through one, two or three of them have next to the origin, among those within their edge or triangle
/// (Caratheodory). A hull that does not hold the origin lies beyond the plane through that point, at right angles to it.
template <class T>
Vector<T> least_in_hull(std::span<const Vector<T>> n, T slack = T(1e-12)) {
  Vector<T> least = n[0];
  const auto consider = [&](std::size_t i, std::size_t j, std::size_t k) {
    Eigen::Matrix<T, 3, 2> sides;
    sides << n[j] - n[i], n[k] - n[i];
    const Eigen::Matrix<T, 2, 1> st = sides.completeOrthogonalDecomposition().solve(-n[i]);
    const Vector<T> p = n[i] + sides * st;
    if (st.minCoeff() >= -slack && st.sum() <= 1 + slack && p.norm() < least.norm()) least = p;
  };
  for (std::size_t i = 0; i < n.size(); ++i)
    for (std::size_t j = i; j < n.size(); ++j)
      for (std::size_t k = j; k < n.size(); ++k) consider(i, j, k);
  for (const Vector<T>& other : n)
    if (other.dot(least) < least.squaredNorm() - slack) return Vector<T>::Zero();
  return least.norm() > slack ? least : Vector<T>::Zero();
}

/// Closest point of the triangle abc to p (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
template <class T>
Vector<T> closest_on_triangle(const Vector<T>& p, const Vector<T>& a, const Vector<T>& b, const Vector<T>& c) {
  const auto on_segment = [&](const Vector<T>& from, const Vector<T>& to) -> Vector<T> {
    const Vector<T> along = to - from;
    const T length2 = along.squaredNorm();
    T s = length2 > 0 ? (p - from).dot(along) / length2 : T(0);
    s = s < 0 ? T(0) : s > 1 ? T(1) : s;
    return from + s * along;
  };
  const Vector<T> n = (b - a).cross(c - a);
  const auto left = [&](const Vector<T>& from, const Vector<T>& to) { return n.cross(to - from).dot(p - from) >= 0; };
  if (n.squaredNorm() > 0 && left(a, b) && left(b, c) && left(c, a)) return p - n * (n.dot(p - a) / n.squaredNorm());
  Vector<T> best = on_segment(a, b);
  for (const Vector<T>& q : {on_segment(b, c), on_segment(c, a)})
    if ((q - p).squaredNorm() < (best - p).squaredNorm()) best = q;
  return best;
}

/// The closest point of a mesh, by looking at every face.
template <class T>
Vector<T> closest_on_mesh(std::span<const Eigen::Vector3d> vertices,
                          std::span<const std::array<std::uint32_t, 3>> faces, const Vector<T>& p) {
  Vector<T> best = Vector<T>::Zero();
  T least = -1;
  for (const auto& f : faces) {
    const Vector<T> q =
        closest_on_triangle<T>(p, vertices[f[0]].cast<T>(), vertices[f[1]].cast<T>(), vertices[f[2]].cast<T>());
    const T d2 = (q - p).squaredNorm();
    if (least < 0 || d2 < least) least = d2, best = q;
  }
  return best;
}

/// Steps of the classical fourth-order method for dx/dt = direction(x), from x over `time` in `steps` equal steps. The first
/// step's first slope is `first` if that is not zero: on the surface the gradient has to be told.
template <class T, class Direction>
Vector<T> runge_kutta(Vector<T> x, T time, int steps, const Vector<T>& first, const Direction& direction) {
  const T h = time / T(steps);
  for (int i = 0; i < steps; ++i) {
    const Vector<T> k1 = i == 0 && first.squaredNorm() > 0 ? first : direction(x), k2 = direction(x + h / 2 * k1),
                    k3 = direction(x + h / 2 * k2), k4 = direction(x + h * k3);
    x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return x;
}

} // namespace cowgpu::reference
