#include "host/physics/spinning_field.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cowgpu::physics {

void check_spin(const Spin& spin) {
  if (!(spin.rate >= 0) || !std::isfinite(spin.rate))
    throw Error(Fault::bad_argument,
                fmt::format("a body turns at a rate of 0 or more, not {}; turn its axis round", spin.rate));
  if (!(std::abs(spin.axis.norm() - 1) < 1e-9))
    throw Error(Fault::bad_argument, fmt::format("a spin's axis has length 1, not {}", spin.axis.norm()));
}

SpinningField::SpinningField(const Body& body, double constant, const Spin& spin, double tolerance,
                             const Backend& backend, Derivatives derivatives)
    : constant_(constant), spin_(spin), derivatives_(derivatives) {
  check_spin(spin);
  const auto add = [&](const ClosedSurface& surface, double density) {
    PolyhedronProblem problem{surface.vertices(), surface.faces()};
    problem.derivatives = derivatives;
    problem.tolerance = tolerance;
    pieces_.push_back(
        {density, backend.polyhedron(problem), backend.distance_field(surface.vertices(), surface.faces())});
  };
  add(body.surface, body.density);
  for (const Part& part : body.parts) add(part.surface, part.density);
}

SpinningValues SpinningField::at(std::span<const Vec3> points, bool depths, Monitor& monitor) const {
  const std::size_t count = points.size();
  SpinningValues found;
  found.geopotential.resize(count);
  const bool first = derivatives_ != Derivatives::none, second = derivatives_ == Derivatives::second;
  if (first) found.acceleration.resize(count, Vec3::Zero());
  if (second) found.gradient.resize(count, Eigen::Matrix3d::Zero());
  if (second) found.on_edge.resize(count);
  found.density.resize(count);
  if (depths) found.depth.resize(count, std::numeric_limits<double>::infinity());
  for (const Piece& piece : pieces_) {
    const PolyhedronValues values = piece.polyhedron->at(points, monitor);
    const double factor = constant_ * piece.density;
    for (std::size_t i = 0; i < count; ++i) {
      found.geopotential[i] -= factor * values.field.value[i];
      if (first) found.acceleration[i] += factor * values.field.gradient[i];
      found.density[i] += piece.density * values.winding[i];
      const double winding = std::abs(values.winding[i]);
      if (winding < 1e6) found.largest_winding = std::max(found.largest_winding, int(std::ceil(winding - 0.25)));
      if (!second) continue;
      const SymmetricTensor& h = values.field.hessian[i];
      found.gradient[i] +=
          factor * (Eigen::Matrix3d() << h[0], h[1], h[2], h[1], h[3], h[4], h[2], h[4], h[5]).finished();
      found.on_edge[i] |= values.on_edge[i];
    }
    if (!depths) continue;
    ClosestOptions unsigned_distance;
    unsigned_distance.with_sign = false;
    const ClosestPoints closest = piece.distance->closest(points, unsigned_distance, monitor);
    for (std::size_t i = 0; i < count; ++i) found.depth[i] = std::min(found.depth[i], closest.distance[i]);
  }
  const double square = spin_.rate * spin_.rate;
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - spin_.axis * spin_.axis.transpose();
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 arm = across * (points[i] - spin_.through);
    found.geopotential[i] -= square * arm.squaredNorm() / 2;
    if (first) found.acceleration[i] += square * arm;
    if (second) found.gradient[i] += square * across;
  }
  return found;
}

MemoryNeed SpinningField::memory(std::uint64_t points) const {
  MemoryNeed sum;
  for (const Piece& piece : pieces_) {
    const MemoryNeed sums = piece.polyhedron->memory(points), closest = piece.distance->memory(points);
    sum.host = std::max(sum.host, sums.host + closest.host);
    sum.device = std::max(sum.device, sums.device + closest.device);
  }
  sum.host += points * (8 + 24 + 72 + 8 + 1 + 8);
  return sum;
}

} // namespace cowgpu::physics
