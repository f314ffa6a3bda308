#include "host/physics/polyhedron.hpp"

#include "host/error.hpp"
#include "host/parallel.hpp"
#include "host/physics/far_field.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace cowgpu::physics {
namespace {

using Real = long double;

constexpr Real four_pi = 4 * std::numbers::pi_v<Real>;
constexpr Real touching = 4 * std::numeric_limits<double>::epsilon(); // part of the largest coordinate
constexpr std::size_t points_per_task = 4;

// a + b - e of a triangle with the side e, whose third corner lies `height` away from that side's line and whose foot is
// `along` from a's end: without the cancellation next to the edge.
Real excess(Real a, Real b, Real e, Real along, Real height2) {
  const Real rest = e - along;
  const Real first = along > 0 ? height2 / (a + along) : a - along;
  const Real second = rest > 0 ? height2 / (b + rest) : b - rest;
  return first + second;
}

} // namespace

Polyhedron::Polyhedron(std::span<const Vec3> vertices, std::span<const Face> faces) {
  vertices_.reserve(vertices.size());
  for (const Vec3& v : vertices) {
    vertices_.push_back(v.cast<Real>());
    size_ = std::max(size_, Real(v.cwiseAbs().maxCoeff()));
  }
  struct Half {
    std::uint32_t low, high;
    LongMatrix3 dyad;
    Real rounding;
  };
  std::vector<Half> halves;
  halves.reserve(3 * faces.size());
  for (const Face& face : faces) {
    const std::array<LongVec3, 3> x = {vertices_[face[0]], vertices_[face[1]], vertices_[face[2]]};
    // From the corner between the two shorter sides: of needles too these are at right angles more often than not, and
    // nothing cancels.
    std::size_t k = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if ((x[(i + 1) % 3] - x[(i + 2) % 3]).squaredNorm() > (x[(k + 1) % 3] - x[(k + 2) % 3]).squaredNorm()) k = i;
    const LongVec3 u = x[(k + 1) % 3] - x[k], v = x[(k + 2) % 3] - x[k];
    const LongVec3 area = u.cross(v);
    const Real norm = area.norm();
    if (!(norm > 0)) continue; // a face without area has no gravity
    const LongVec3 normal = area / norm;
    const LongVec3 first = u.cwiseAbs(), second = v.cwiseAbs();
    const LongVec3 products(first.y() * second.z() + first.z() * second.y(),
                            first.z() * second.x() + first.x() * second.z(),
                            first.x() * second.y() + first.y() * second.x());
    const Real rounding = 1 + products.norm() / norm;
    sides_.push_back({face, normal, norm});
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = face[i], to = face[(i + 1) % 3];
      const LongVec3 outward = (vertices_[to] - vertices_[from]).normalized().cross(normal);
      halves.push_back({std::min(from, to), std::max(from, to), normal * outward.transpose(), rounding});
    }
  }
  std::stable_sort(halves.begin(), halves.end(),
                   [](const Half& a, const Half& b) { return std::pair(a.low, a.high) < std::pair(b.low, b.high); });
  for (std::size_t i = 0; i < halves.size();) {
    const LongVec3 along = vertices_[halves[i].high] - vertices_[halves[i].low];
    Edge edge{halves[i].low, halves[i].high, along.norm(), along.normalized(), LongMatrix3::Zero(), false, 0};
    for (; i < halves.size() && halves[i].low == edge.from && halves[i].high == edge.to; ++i) {
      edge.dyad += halves[i].dyad;
      edge.rounding = std::hypot(edge.rounding, halves[i].rounding);
    }
    edge.flat = edge.dyad.norm() < 1e-13L;
    spread_ = std::hypot(spread_, edge.rounding * edge.length);
    edges_.push_back(edge);
  }
}

void Polyhedron::add_edge(const Edge& edge, const Scratch& scratch, Real tolerance, PolyhedronAt& sum) const {
  const LongVec3& r = scratch.to[edge.from];
  const Real along = -r.dot(edge.direction), height2 = r.cross(edge.direction).squaredNorm();
  if (height2 <= tolerance * tolerance && along >= -tolerance && along <= edge.length + tolerance) {
    // r E r L and E r L are 0 in the limit.
    sum.on_edge = sum.on_edge || !edge.flat;
    return;
  }
  const Real below = excess(scratch.distances[edge.from], scratch.distances[edge.to], edge.length, along, height2);
  const Real factor = std::log1p(2 * edge.length / below);
  const LongVec3 across = edge.dyad * r;
  sum.value += r.dot(across) * factor / 2;
  sum.gradient -= across * factor;
  sum.hessian += edge.dyad * factor;
}

void Polyhedron::add_side(const Side& side, const Scratch& scratch, Real tolerance, PolyhedronAt& sum) {
  const auto& [a, b, c] = side.corners;
  const LongVec3 &ra = scratch.to[a], &rb = scratch.to[b], &rc = scratch.to[c];
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
  sum.winding += angle / four_pi;
}

PolyhedronAt Polyhedron::at(const LongVec3& point, Scratch& scratch) const {
  scratch.to.resize(vertices_.size());
  scratch.distances.resize(vertices_.size());
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    scratch.to[v] = vertices_[v] - point;
    scratch.distances[v] = scratch.to[v].norm();
  }
  const Real tolerance = touching * size_;
  PolyhedronAt sum;
  for (const Edge& edge : edges_) add_edge(edge, scratch, tolerance, sum);
  for (const Side& side : sides_) add_side(side, scratch, tolerance, sum);
  sum.hessian = (sum.hessian + sum.hessian.transpose().eval()) / 2;
  return sum;
}

PolyhedronAt Polyhedron::at(const Vec3& point) const {
  Scratch scratch;
  return at(point.cast<Real>(), scratch);
}

FieldError Polyhedron::rounding(Real reach) const {
  const Real unit = std::numeric_limits<Real>::epsilon() * spread_;
  return {unit * reach, unit, unit / reach};
}

namespace {

struct Piece {
  Polyhedron polyhedron;
  Real density;
};

FieldError rounding(const std::vector<Piece>& pieces, Real reach) {
  FieldError sum;
  for (const Piece& piece : pieces) {
    const FieldError error = piece.polyhedron.rounding(reach);
    sum.value += std::fabs(piece.density) * error.value;
    sum.gradient += std::fabs(piece.density) * error.gradient;
    sum.hessian += std::fabs(piece.density) * error.hessian;
  }
  return sum;
}

[[noreturn]] void refuse_edge(const Vec3& p) {
  throw Error(Fault::point_singular,
              fmt::format("the point ({}, {}, {}) lies on an edge of the body, where the second derivatives of its "
                          "potential are infinite; move it, or ask for potential and acceleration alone "
                          "(--derivatives 1)",
                          p[0], p[1], p[2]));
}

PolyhedronAt by_polyhedron(const std::vector<Piece>& pieces, const Vec3& point, Polyhedron::Scratch& room) {
  PolyhedronAt sum;
  for (const Piece& piece : pieces) {
    const PolyhedronAt at = piece.polyhedron.at(point.cast<Real>(), room);
    sum.value += piece.density * at.value;
    sum.gradient += piece.density * at.gradient;
    sum.hessian += piece.density * at.hessian;
    sum.winding += piece.density * at.winding;
    sum.on_edge = sum.on_edge || at.on_edge;
  }
  return sum;
}

PolyhedronAt by_series(const FarField& far, const Vec3& point) {
  const auto at = far.at(point.cast<Real>());
  PolyhedronAt sum;
  sum.value = at.value;
  sum.gradient = at.gradient;
  sum.hessian = at.hessian;
  return sum;
}

// The worse of the relative errors of value and gradient.
double relative_error(const PolyhedronAt& at, const FieldError& error, Real distance, Derivatives derivatives) {
  constexpr Real rounded = std::numeric_limits<double>::epsilon() / 2;
  const Real value = std::fabs(at.value);
  const auto part = [](Real a, Real b) { return a == 0 ? 0 : a / b; };
  Real worst = part(error.value, value);
  if (derivatives != Derivatives::none)
    worst = std::max(worst, part(error.gradient, std::max(at.gradient.norm(), value / distance)));
  return double(worst + rounded);
}

} // namespace

ExactField exact_field(const Body& body, std::span<const Vec3> points, Derivatives derivatives, unsigned threads,
                       Monitor& monitor) {
  std::vector<Piece> pieces;
  pieces.push_back({Polyhedron(body.surface.vertices(), body.surface.faces()), body.density});
  for (const Part& part : body.parts)
    pieces.push_back({Polyhedron(part.surface.vertices(), part.surface.faces()), part.density});
  const std::size_t count = points.size();
  ExactField found;
  found.density.resize(count);
  found.by_series.resize(count);
  found.field.value.resize(count);
  if (derivatives != Derivatives::none) found.field.gradient.resize(count);
  if (derivatives == Derivatives::second) found.field.hessian.resize(count);
  const Middle about = middle(body);
  std::vector<Real> distances(count);
  bool far_ones = false;
  const Real mass = std::fabs(Real(body.mass()));
  for (std::size_t i = 0; i < count; ++i) {
    if (!points[i].allFinite()) throw Error(Fault::bad_argument, "a point is not finite");
    const Real d = distances[i] = (points[i].cast<Real>() - about.centre.cast<Real>()).norm();
    // Where the closed form is right to doubles no series is needed.
    far_ones = far_ones || (d > about.radius && rounding(pieces, d + about.radius).value * d >
                                                    std::numeric_limits<double>::epsilon() / 4 * mass);
  }
  std::optional<FarField> far;
  if (far_ones) far.emplace(body, monitor);
  if (threads == 0) threads = all_threads();
  std::vector<Polyhedron::Scratch> scratch(threads);
  std::vector<double> errors(threads);
  std::atomic<std::size_t> done = 0;
  const auto one = [&](std::size_t i, unsigned thread) {
    const Real d = distances[i];
    FieldError error = rounding(pieces, d + about.radius);
    if (far && d > about.radius) {
      const FieldError series = far->error(d);
      found.by_series[i] = series.value < error.value &&
                           (derivatives == Derivatives::none || series.gradient < error.gradient) &&
                           (derivatives != Derivatives::second || series.hessian < error.hessian);
      if (found.by_series[i]) error = series;
    }
    const PolyhedronAt at =
        found.by_series[i] ? by_series(*far, points[i]) : by_polyhedron(pieces, points[i], scratch[thread]);
    if (at.on_edge && derivatives == Derivatives::second) refuse_edge(points[i]);
    errors[thread] = std::max(errors[thread], relative_error(at, error, std::max<Real>(d, about.radius), derivatives));
    found.density[i] = double(at.winding);
    found.field.value[i] = double(at.value);
    if (derivatives == Derivatives::none) return;
    found.field.gradient[i] = at.gradient.cast<double>();
    if (derivatives == Derivatives::first) return;
    const auto& h = at.hessian;
    found.field.hessian[i] = {double(h(0, 0)), double(h(0, 1)), double(h(0, 2)),
                              double(h(1, 1)), double(h(1, 2)), double(h(2, 2))};
  };
  parallel_for(threads, (count + points_per_task - 1) / points_per_task, [&](std::size_t task, unsigned thread) {
    const std::size_t end = std::min(count, (task + 1) * points_per_task);
    for (std::size_t i = task * points_per_task; i < end; ++i) {
      check_stop(monitor);
      one(i, thread);
      const std::size_t now = ++done;
      if (thread == 0) monitor.progress("exact potential", double(now) / double(count));
    }
  });
  found.error = *std::max_element(errors.begin(), errors.end());
  return found;
}

std::uint64_t exact_field_bytes(const Body& body, std::uint64_t points, unsigned threads) {
  std::uint64_t vertices = body.surface.vertices().size(), faces = body.surface.faces().size();
  for (const Part& part : body.parts) {
    vertices += part.surface.vertices().size();
    faces += part.surface.faces().size();
  }
  // Halves of edges are sorted beside the edges, each about 200 bytes.
  return vertices * 48 * (1 + (threads ? threads : all_threads())) + 64 * vertices + faces * (3 * 400 + 2 * 240 + 96) +
         points * 8 * 11;
}

} // namespace cowgpu::physics
