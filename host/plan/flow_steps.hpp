// The pieces that a path of the distance flow steps with. A device does the same operations in the same order
// (shaders/flow.comp) and gets the same bits.
#pragma once

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <span>

namespace cowgpu::plan {

template <class T>
using Vector = Eigen::Matrix<T, 3, 1>;

/// Sums of three in one order: those of Eigen's dot() go with the instruction set.
template <class T>
T dot(const Vector<T>& a, const Vector<T>& b) {
  return a[0] * b[0] + (a[1] * b[1] + a[2] * b[2]);
}
template <class T>
T norm(const Vector<T>& a) {
  return std::sqrt(dot<T>(a, a));
}

/// The point of least norm in the convex hull of `n` vectors, and the weights of the vectors in it: by trying every
/// subset of up to three for the optimality condition v . n_j >= |v|^2. Returns false, and v = 0, if the hull holds the
/// origin.
template <class T>
bool least_norm_in_hull(std::span<const Vector<T>> n, Vector<T>& v, std::span<T> weights, T slack = T(1e-10)) {
  const std::size_t m = n.size();
  for (T& w : weights) w = 0;
  const auto optimal = [&](const Vector<T>& p) {
    const T norm2 = dot<T>(p, p);
    for (const auto& other : n)
      if (dot<T>(other, p) < norm2 - slack) return false;
    v = p;
    return true;
  };
  for (std::size_t i = 0; i < m; ++i)
    if (optimal(n[i])) return weights[i] = 1, true;
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = i + 1; j < m; ++j) {
      const Vector<T> ij = n[j] - n[i];
      const T length2 = dot<T>(ij, ij);
      if (!(length2 > 0)) continue;
      const T s = -dot<T>(n[i], ij) / length2;
      if (s < 0 || s > 1 || !optimal(n[i] + s * ij)) continue;
      weights[i] = 1 - s;
      weights[j] = s;
      return dot<T>(v, v) > slack * slack;
    }
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = i + 1; j < m; ++j)
      for (std::size_t k = j + 1; k < m; ++k) {
        const Vector<T> a = n[j] - n[i], c = n[k] - n[i];
        const T aa = dot<T>(a, a), cc = dot<T>(c, c), ac = dot<T>(a, c), ra = -dot<T>(a, n[i]), rc = -dot<T>(c, n[i]);
        const T determinant = aa * cc - ac * ac;
        if (!(determinant > T(1e-18) * aa * cc)) continue;
        const T s = (ra * cc - rc * ac) / determinant, t = (rc * aa - ra * ac) / determinant;
        constexpr double margin = 1e-9;
        if (s < -margin || t < -margin || s + t > 1 + margin || !optimal(n[i] + s * a + t * c)) continue;
        weights[i] = 1 - s - t;
        weights[j] = s;
        weights[k] = t;
        return dot<T>(v, v) > slack * slack;
      }
  v.setZero();
  return false;
}

/// One round of the shrinking ball (Ma, Bae and Choi, The Visual Computer 28 (2012) 7). A ball of `radius` touches the plane
/// through q with normal n there; p is the closest surface point to its centre. True if p lies inside by more than `slack`:
/// `radius` is then that of the smaller ball through p, |p - q|^2 / (2 (p - q) . n).
template <class T>
bool shrink(const Vector<T>& q, const Vector<T>& n, const Vector<T>& p, T slack, T& radius) {
  const Vector<T> centre = q + radius * n, pq = p - q;
  if (norm<T>(p - centre) >= radius - slack) return false;
  const T height = dot<T>(pq, n);
  if (!(height > 0)) return false;
  const T smaller = dot<T>(pq, pq) / (2 * height);
  if (!(smaller < radius)) return false;
  radius = smaller;
  return true;
}

/// One step of Dormand and Prince, J. Comput. Appl. Math. 6 (1980) 19: fifth order, with an estimate of the error of the
/// embedded fourth-order result. `k1` is the slope at x.
template <class T, class Direction>
Vector<T> dormand_prince(const Vector<T>& x, T h, const Vector<T>& k1, const Direction& direction, T* error = nullptr) {
  const Vector<T> k2 = direction(x + h * (T(1) / 5 * k1));
  const Vector<T> k3 = direction(x + h * (T(3) / 40 * k1 + T(9) / 40 * k2));
  const Vector<T> k4 = direction(x + h * (T(44) / 45 * k1 - T(56) / 15 * k2 + T(32) / 9 * k3));
  const Vector<T> k5 =
      direction(x + h * (T(19372) / 6561 * k1 - T(25360) / 2187 * k2 + T(64448) / 6561 * k3 - T(212) / 729 * k4));
  const Vector<T> k6 = direction(x + h * (T(9017) / 3168 * k1 - T(355) / 33 * k2 + T(46732) / 5247 * k3 +
                                          T(49) / 176 * k4 - T(5103) / 18656 * k5));
  const Vector<T> y =
      x + h * (T(35) / 384 * k1 + T(500) / 1113 * k3 + T(125) / 192 * k4 - T(2187) / 6784 * k5 + T(11) / 84 * k6);
  if (error) {
    const Vector<T> k7 = direction(y);
    *error = norm<T>(h * (T(71) / 57600 * k1 - T(71) / 16695 * k3 + T(71) / 1920 * k4 - T(17253) / 339200 * k5 +
                          T(22) / 525 * k6 - T(1) / 40 * k7));
  }
  return y;
}

} // namespace cowgpu::plan
