// Reference of the stage `polyhedron`: plain scalar code on any number type, the oracle of all fast paths.
#pragma once

#include "host/types.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace cowgpu::reference {

/// V = integral of 1/|x - p| over the inside, each point counted as often as the surface winds about it, and its derivatives.
template <class Real>
struct PolyhedronAt {
  using Vector = Eigen::Matrix<Real, 3, 1>;
  using Matrix = Eigen::Matrix<Real, 3, 3>;

  Real value = 0;
  Vector gradient = Vector::Zero();
  Matrix hessian = Matrix::Zero(); ///< on a face the mean of both sides'; infinite on edges
  Real winding = 0;                ///< winding number about the point, -(trace of the hessian)/4 pi; on a face the mean
  bool on_edge = false; ///< or on a vertex, where faces that meet there are not coplanar: the hessian leaves it out
};

/// Estimates of absolute errors of V, of its gradient (a norm) and of its second derivatives.
template <class Real>
struct FieldError {
  Real value = 0, gradient = 0, hessian = 0;
};

/// R. A. Werner and D. J. Scheeres, Exterior gravitation of a polyhedron derived and compared with harmonic and mascon
/// gravitation representations of asteroid 4769 Castalia, Celest. Mech. Dyn. Astron. 65 (1997) 313: with the solid angle w_f
/// of each face (eq. 6), L_e = ln((a + b + e)/(a + b - e)) of each edge (eq. 7), and vectors r from the point to them,
///   V = sum r E r L_e / 2 - sum r F r w_f / 2,  grad V = -sum E r L_e + sum F r w_f,  dd V = sum E L_e - sum F w_f
/// (eqs. 10, 15, 16), F the dyad n n of a face and E the sum of n n_e over the faces at an edge. 80-bit arithmetic, since
/// these sums cancel like (distance/size)^2.
template <class Real>
class Polyhedron {
public:
  using Vector = Eigen::Matrix<Real, 3, 1>;
  using Matrix = Eigen::Matrix<Real, 3, 3>;
  using At = PolyhedronAt<Real>;

  /// A closed surface; edges with more than two faces, cavities and faces without area may occur.
  Polyhedron(std::span<const Vec3> vertices, std::span<const Face> faces);

  /// Room for at(), one for each thread.
  struct Scratch {
    std::vector<Vector> to;
    std::vector<Real> distances;
  };

  /// `point` in mesh coordinates. What is nearer to a face or an edge than the rounding of coordinates is on it: there value
  /// and gradient have their limits.
  At at(const Vector& point, Scratch& scratch) const;
  At at(const Vec3& point) const;

  /// Rounding of at() at points no farther than `reach` from each vertex: every edge adds r E r L_e/2 ~ reach e/2 and E r L_e ~ e,
  /// right to some units in the last place of an 80-bit number (more where the normals at the edge are those of needles),
  /// whose errors add like those of a random walk. On bodies of size e V is about e^3/reach, so that of V a part of
  /// (reach/e)^2 units is lost.
  FieldError<Real> rounding(Real reach) const;

private:
  struct Edge {
    std::uint32_t from, to;
    Real length;
    Vector direction;
    Matrix dyad;
    bool flat;     // its dyad is zero but for rounding
    Real rounding; // rounding of the dyad, in units of the last place
  };
  struct Side {
    std::array<std::uint32_t, 3> corners;
    Vector normal;
    Real double_area;
  };
  void add_edge(const Edge& edge, const Scratch& scratch, Real tolerance, At& sum) const;
  static void add_side(const Side& side, const Scratch& scratch, Real tolerance, At& sum);

  std::vector<Vector> vertices_;
  std::vector<Edge> edges_;
  std::vector<Side> sides_;
  Real size_ = 0;   // largest coordinate
  Real spread_ = 0; // root of the sum of (rounding times length)^2 of the edges
};

namespace detail {

template <class Real>
inline constexpr Real four_pi = 4 * std::numbers::pi_v<Real>;
template <class Real>
inline constexpr Real touching = 4 * std::numeric_limits<double>::epsilon(); // part of the largest coordinate

// a + b - e of a triangle with the side e, whose third corner lies `height` away from that side's line and whose foot is
// `along` from a's end: without the cancellation next to the edge.
template <class Real>
Real excess(Real a, Real b, Real e, Real along, Real height2) {
  const Real rest = e - along;
  const Real first = along > 0 ? height2 / (a + along) : a - along;
  const Real second = rest > 0 ? height2 / (b + rest) : b - rest;
  return first + second;
}

} // namespace detail

template <class Real>
Polyhedron<Real>::Polyhedron(std::span<const Vec3> vertices, std::span<const Face> faces) {
  vertices_.reserve(vertices.size());
  for (const Vec3& v : vertices) {
    vertices_.push_back(v.template cast<Real>());
    size_ = std::max(size_, Real(v.cwiseAbs().maxCoeff()));
  }
  struct Half {
    std::uint32_t low, high;
    Matrix dyad;
    Real rounding;
  };
  std::vector<Half> halves;
  halves.reserve(3 * faces.size());
  for (const Face& face : faces) {
    const std::array<Vector, 3> x = {vertices_[face[0]], vertices_[face[1]], vertices_[face[2]]};
    // From the corner between the two shorter sides: of needles too these are at right angles more often than not, and
    // nothing cancels.
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if ((x[(i + 1) % 3] - x[(i + 2) % 3]).squaredNorm() > (x[(k + 1) % 3] - x[(k + 2) % 3]).squaredNorm()) k = i;
    const Vector u = x[(k + 1) % 3] - x[k], v = x[(k + 2) % 3] - x[k];
    const Vector area = u.cross(v);
    const Real norm = area.norm();
    if (!(norm > 0)) continue; // a face without area has no gravity
    const Vector normal = area / norm;
    const Vector first = u.cwiseAbs(), second = v.cwiseAbs();
    const Vector products(first.y() * second.z() + first.z() * second.y(),
                          first.z() * second.x() + first.x() * second.z(),
                          first.x() * second.y() + first.y() * second.x());
    const Real rounding = 1 + products.norm() / norm;
    sides_.push_back({face, normal, norm});
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = face[i], to = face[(i + 1) % 3];
      const Vector outward = (vertices_[to] - vertices_[from]).normalized().cross(normal);
      halves.push_back({std::min(from, to), std::max(from, to), normal * outward.transpose(), rounding});
    }
  }
  std::stable_sort(halves.begin(), halves.end(),
                   [](const Half& a, const Half& b) { return std::pair(a.low, a.high) < std::pair(b.low, b.high); });
  for (std::size_t i = 0; i < halves.size();) {
    const Vector along = vertices_[halves[i].high] - vertices_[halves[i].low];
    Edge edge{halves[i].low, halves[i].high, along.norm(), along.normalized(), Matrix::Zero(), false, 0};
    for (; i < halves.size() && halves[i].low == edge.from && halves[i].high == edge.to; ++i) {
      edge.dyad += halves[i].dyad;
      edge.rounding = std::hypot(edge.rounding, halves[i].rounding);
    }
    edge.flat = edge.dyad.norm() < Real(1e-13L);
    spread_ = std::hypot(spread_, edge.rounding * edge.length);
    edges_.push_back(edge);
  }
}

template <class Real>
void Polyhedron<Real>::add_edge(const Edge& edge, const Scratch& scratch, Real tolerance, At& sum) const {
  const Vector& r = scratch.to[edge.from];
  const Real along = -r.dot(edge.direction), height2 = r.cross(edge.direction).squaredNorm();
  if (height2 <= tolerance * tolerance && along >= -tolerance && along <= edge.length + tolerance) {
    // r E r L and E r L are 0 in the limit.
    sum.on_edge = sum.on_edge || !edge.flat;
    return;
  }
  const Real below =
      detail::excess(scratch.distances[edge.from], scratch.distances[edge.to], edge.length, along, height2);
  const Real factor = std::log1p(2 * edge.length / below);
  const Vector across = edge.dyad * r;
  sum.value += r.dot(across) * factor / 2;
  sum.gradient -= across * factor;
  sum.hessian += edge.dyad * factor;
}

template <class Real>
void Polyhedron<Real>::add_side(const Side& side, const Scratch& scratch, Real tolerance, At& sum) {
  const auto& [a, b, c] = side.corners;
  const Vector &ra = scratch.to[a], &rb = scratch.to[b], &rc = scratch.to[c];
  const Real da = scratch.distances[a], db = scratch.distances[b], dc = scratch.distances[c];
  // The nearest corner knows the height best.
  const Real height = side.normal.dot(da <= db && da <= dc ? ra : db <= dc ? rb : rc);
  // In its plane the angle is 0, and on the face itself the mean of both sides'.
  if (std::fabs(height) <= tolerance) return;
  const Real cosine = da * db * dc + da * rb.dot(rc) + db * rc.dot(ra) + dc * ra.dot(rb);
  const Real angle = 2 * std::atan2(side.double_area * height, cosine);
  sum.value -= height * height * angle / 2;
  sum.gradient += side.normal * (height * angle);
  sum.hessian -= side.normal * side.normal.transpose() * angle;
  sum.winding += angle / detail::four_pi<Real>;
}

template <class Real>
PolyhedronAt<Real> Polyhedron<Real>::at(const Vector& point, Scratch& scratch) const {
  scratch.to.resize(vertices_.size());
  scratch.distances.resize(vertices_.size());
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    scratch.to[v] = vertices_[v] - point;
    scratch.distances[v] = scratch.to[v].norm();
  }
  const Real tolerance = detail::touching<Real> * size_;
  At sum;
  for (const Edge& edge : edges_) add_edge(edge, scratch, tolerance, sum);
  for (const Side& side : sides_) add_side(side, scratch, tolerance, sum);
  sum.hessian = (sum.hessian + sum.hessian.transpose().eval()) / 2;
  return sum;
}

template <class Real>
PolyhedronAt<Real> Polyhedron<Real>::at(const Vec3& point) const {
  Scratch scratch;
  return at(point.template cast<Real>(), scratch);
}

template <class Real>
FieldError<Real> Polyhedron<Real>::rounding(Real reach) const {
  const Real unit = std::numeric_limits<Real>::epsilon() * spread_;
  return {unit * reach, unit, unit / reach};
}

} // namespace cowgpu::reference
