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

constexpr std::size_t points_per_task = 4;

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
