#include "host/plan/polyhedron_call.hpp"

#include "host/error.hpp"
#include "host/geometry/morton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>

namespace cowgpu::plan {

PolyhedronSurface polyhedron_surface(const PolyhedronProblem& problem, unsigned threads) {
  PolyhedronSurface surface;
  surface.unit = polyhedron_unit(problem.vertices);
  surface.touching = touching_distance(problem.vertices);
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vec3& v : problem.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  if (problem.vertices.empty()) low = high = Vec3::Zero();
  surface.middle = low + (high - low) / 2;
  for (const Vec3& v : problem.vertices) surface.radius = std::max(surface.radius, (v - surface.middle).norm());
  std::vector<Vec3> centroids(problem.faces.size());
  for (std::size_t f = 0; f < centroids.size(); ++f) {
    const Face& face = problem.faces[f];
    centroids[f] = problem.vertices[face[0]] / 3 + problem.vertices[face[1]] / 3 + problem.vertices[face[2]] / 3;
  }
  surface.order = morton_order(centroids, low, high, threads);
  for (std::size_t f = 0; f < centroids.size(); f += direct_patch) surface.starts.push_back(std::uint32_t(f));
  surface.starts.push_back(std::uint32_t(centroids.size()));
  if (problem.derivatives == Derivatives::second) surface.sharp = sharp_edges(problem.vertices, problem.faces);
  return surface;
}

PolyhedronPoints polyhedron_points(const PolyhedronSurface& surface, std::span<const Vec3> points, unsigned threads) {
  if (points.size() > std::size_t(1) << 31)
    throw Error(Fault::too_large, fmt::format("{} points: at most 2^31 at once", points.size()));
  PolyhedronPoints found;
  std::vector<Vec3> near;
  std::vector<std::uint32_t> ids;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    if (!p.allFinite())
      throw Error(Fault::bad_argument,
                  fmt::format("point {} is ({}, {}, {}): it has to be finite", i, p[0], p[1], p[2]));
    // stableNorm: no overflow of squares
    if ((p / 2 - surface.middle / 2).stableNorm() > far_radii / 2 * surface.radius) {
      found.far.push_back(std::uint32_t(i));
    } else {
      ids.push_back(std::uint32_t(i));
      near.push_back(p);
    }
  }
  const Vec3 side = Vec3::Constant(far_radii * surface.radius);
  found.near = morton_order(near, surface.middle - side, surface.middle + side, threads);
  for (std::uint32_t& i : found.near) i = ids[i];
  return found;
}

MomentProblem far_moments(const PolyhedronProblem& problem, const PolyhedronSurface& surface) {
  MomentProblem moments;
  moments.vertices = problem.vertices;
  moments.faces = problem.faces;
  moments.origin = surface.middle;
  // A vertex at the radius may have been rounded outside.
  moments.reference_radius = surface.radius > 0 ? surface.radius * (1 + 1e-15) : 1;
  moments.lmax = far_degree;
  return moments;
}

std::vector<Vec3> far_places(const PolyhedronSurface& surface, std::span<const Vec3> points,
                             std::span<const std::uint32_t> far) {
  std::vector<Vec3> places;
  places.reserve(far.size());
  for (const std::uint32_t i : far) places.emplace_back(points[i] - surface.middle);
  return places;
}

PolyhedronValues polyhedron_values(const PolyhedronProblem& problem, std::size_t points) {
  PolyhedronValues values;
  values.field.value.resize(points);
  values.winding.resize(points);
  if (problem.derivatives != Derivatives::none) values.field.gradient.resize(points, Vec3::Zero());
  if (problem.derivatives == Derivatives::second) {
    values.field.hessian.resize(points);
    values.on_edge.resize(points);
  }
  if (problem.guarantee) values.bound.resize(points);
  return values;
}

void store_sums(const PolyhedronProblem& problem, double unit, const double* sums, std::size_t stride,
                std::size_t point, PolyhedronValues& values) {
  using Rows = PolyhedronRows;
  const auto row = [&](std::size_t r) { return sums[r * stride]; };
  values.field.value[point] = row(Rows::value) * unit * unit;
  double winding = row(Rows::winding);
  if (problem.derivatives != Derivatives::none)
    values.field.gradient[point] = unit * Vec3(row(Rows::gradient), row(Rows::gradient + 1), row(Rows::gradient + 2));
  if (problem.derivatives == Derivatives::second) {
    const bool on_edge = row(Rows::on_edge) > 0;
    const double part = on_edge || problem.side == FaceSide::mean ? 0 : problem.side == FaceSide::outer ? 1 : -1;
    SymmetricTensor& hessian = values.field.hessian[point];
    for (std::size_t k = 0; k < 6; ++k) hessian[k] = row(Rows::hessian + k) + part * row(Rows::jump + k);
    constexpr double quarter = 0.25 * std::numbers::inv_pi;
    winding -= part * quarter * (row(Rows::jump) + row(Rows::jump + 3) + row(Rows::jump + 5));
    values.on_edge[point] = on_edge ? 1 : 0;
  }
  values.winding[point] = winding;
}

void store_far(const PotentialField& field, std::span<const std::uint32_t> far, PolyhedronValues& values) {
  for (std::size_t i = 0; i < far.size(); ++i) {
    values.field.value[far[i]] = field.value[i];
    if (!field.gradient.empty()) values.field.gradient[far[i]] = field.gradient[i];
    if (!field.hessian.empty()) values.field.hessian[far[i]] = field.hessian[i];
  }
}

std::uint64_t polyhedron_call_bytes(const PolyhedronProblem& problem, std::uint64_t points) {
  const std::uint64_t faces = problem.faces.size();
  // Centroids and their keys, the order, halves of edges; points sorted alike, and their values.
  return faces * (24 + 16 + 8 + 1 + 3 * 12) + problem.vertices.size() * 16 + points * (24 + 16 + 3 * 8 + 8 * 12 + 1);
}

} // namespace cowgpu::plan
