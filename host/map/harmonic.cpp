#include "host/map/harmonic.hpp"

#include "host/error.hpp"
#include "host/map/moebius.hpp"
#include "host/map/polish.hpp"
#include "host/map/solve.hpp"
#include "host/mesh/geometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

namespace cowgpu {

namespace {

// The largest y at which the line (x, z) meets the surface. Signs are antisymmetric along an edge, so a line through an
// edge or a vertex is not lost between the faces.
std::optional<double> highest_crossing(const ManifoldSurface& surface, double x, double z) {
  std::optional<double> highest;
  for (const Face& face : surface.faces()) {
    Vec3 corner[3];
    for (std::size_t k = 0; k < 3; ++k) corner[k] = surface.vertices()[face[k]] - Vec3(x, 0, z);
    double weight[3], sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = corner[(k + 1) % 3], &b = corner[(k + 2) % 3];
      weight[k] = a.x() * b.z() - a.z() * b.x();
      sum += weight[k];
    }
    const auto [least, most] = std::minmax({weight[0], weight[1], weight[2]});
    if ((least < 0 && most > 0) || sum == 0) continue;
    double y = 0;
    for (std::size_t k = 0; k < 3; ++k) y += weight[k] / sum * corner[k].y();
    if (!highest || y > *highest) highest = y;
  }
  return highest;
}

std::uint32_t nearest_vertex(const ManifoldSurface& surface, const Vec3& point) {
  std::uint32_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (const Face& face : surface.faces())
    for (const std::uint32_t v : face) {
      const double distance = (surface.vertices()[v] - point).stableNorm();
      if (distance < least || (distance == least && v < nearest)) {
        least = distance;
        nearest = v;
      }
    }
  return nearest;
}

// A harmonic map of the surface without the pole to the unit disk.
struct Disk {
  std::vector<std::complex<double>> w; // one a vertex; the pole's means nothing
  std::vector<std::uint32_t> loop;
  double residual = 0;
};

Disk harmonic_disk(const ManifoldSurface& surface, const HalfEdges& half_edges, const SparseMatrix& laplace,
                   EdgeWeights weights, std::uint32_t pole, Monitor& monitor) {
  const auto& vertices = surface.vertices();
  Disk disk;
  disk.w.assign(vertices.size(), 0);
  disk.loop = half_edges.ring(surface.faces(), pole);
  std::reverse(disk.loop.begin() + 1, disk.loop.end()); // seen from the faces that stay

  const std::size_t around = disk.loop.size();
  std::vector<long double> length(around + 1, 0);
  for (std::size_t i = 0; i < around; ++i)
    length[i + 1] = length[i] + (vertices[disk.loop[(i + 1) % around]] - vertices[disk.loop[i]]).stableNorm();
  for (std::size_t i = 0; i < around; ++i)
    disk.w[disk.loop[i]] = std::polar(1.0L, 2 * std::numbers::pi_v<long double> * length[i] / length[around]);

  constexpr int known = -1;
  std::vector<int> unknown(vertices.size(), known);
  std::vector<std::uint32_t> vertex_of;
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    if (half_edges.leaving(v) != HalfEdges::none) unknown[v] = 0;
  unknown[pole] = known;
  for (const std::uint32_t v : disk.loop) unknown[v] = known;
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    if (unknown[v] != known) {
      unknown[v] = int(vertex_of.size());
      vertex_of.push_back(v);
    }

  const auto size = Eigen::Index(vertex_of.size());
  SparseMatrix matrix(size, size);
  matrix.reserve(laplace.nonZeros());
  for (int column = 0; column < size; ++column) {
    matrix.startVec(column);
    for (SparseMatrix::InnerIterator entry(laplace, vertex_of[std::size_t(column)]); entry; ++entry)
      if (unknown[std::size_t(entry.row())] != known)
        matrix.insertBack(unknown[std::size_t(entry.row())], column) = entry.value();
  }
  matrix.finalize();
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(size, 2), solution;
  for (const std::uint32_t v : disk.loop)
    for (SparseMatrix::InnerIterator entry(laplace, v); entry; ++entry)
      if (const int row = unknown[std::size_t(entry.row())]; row != known) {
        right(row, 0) -= entry.value() * disk.w[v].real();
        right(row, 1) -= entry.value() * disk.w[v].imag();
      }

  const std::string what = "the system of the harmonic map to the disk";
  if (weights == EdgeWeights::mean_value) {
    solution = solve_general(matrix, right, what, &disk.residual);
  } else {
    SymmetricSolver solver(matrix, what, Ordering::automatic, monitor);
    solution = solver.solve(right);
    disk.residual = solver.residual();
  }
  for (Eigen::Index i = 0; i < size; ++i) disk.w[vertex_of[std::size_t(i)]] = {solution(i, 0), solution(i, 1)};
  return disk;
}

// The scale that puts half of the area inside the unit circle; the pole's own part is outside.
double halving_scale(const Disk& disk, std::span<const double> areas, std::uint32_t pole) {
  std::vector<std::uint32_t> order(disk.w.size());
  std::iota(order.begin(), order.end(), 0U);
  std::erase_if(order, [&](std::uint32_t v) { return v == pole || areas[v] == 0; });
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return std::norm(disk.w[a]) < std::norm(disk.w[b]); });
  double inside = 0, radius = 1;
  for (const std::uint32_t v : order) {
    radius = std::abs(disk.w[v]);
    inside += areas[v];
    if (inside >= 0.5) break;
  }
  return radius > 0 ? 1 / radius : 1;
}

} // namespace

std::uint32_t pole_vertex(const ManifoldSurface& surface, const Pole& pole) {
  if (pole.rule == Pole::Rule::vertex) {
    if (pole.vertex >= surface.vertices().size())
      throw Error(Fault::bad_argument, fmt::format("vertex {} cannot be the pole: the mesh has the vertices 0 to {}",
                                                   pole.vertex, surface.vertices().size() - 1));
    for (const Face& face : surface.faces())
      if (std::find(face.begin(), face.end(), pole.vertex) != face.end()) return pole.vertex;
    throw Error(Fault::bad_argument, fmt::format("vertex {} cannot be the pole: it belongs to no face", pole.vertex));
  }
  if (pole.rule == Pole::Rule::point) {
    if (!pole.point.allFinite()) throw Error(Fault::bad_argument, "the pole's coordinates must be finite numbers");
    return nearest_vertex(surface, pole.point);
  }
  const Box box = bounding_box(surface.closed());
  const Vec3 middle = box.middle();
  const double top = highest_crossing(surface, middle.x(), middle.z()).value_or(box.max.y());
  return nearest_vertex(surface, {middle.x(), top, middle.z()});
}

SphereMap harmonic_map(const ManifoldSurface& surface, const HarmonicOptions& options, Monitor& monitor) {
  if (!(options.disk_scale >= 0) || !std::isfinite(options.disk_scale))
    throw Error(Fault::bad_argument,
                fmt::format("a disk cannot be scaled by {}: give a positive number, or none to let "
                            "each hemisphere have half of the area",
                            options.disk_scale));
  const bool polishable = options.weights != EdgeWeights::mean_value;
  const bool polishes = options.polish.value_or(polishable && options.disk_scale == 0 && !options.centre);
  if (polishes && !polishable)
    throw Error(Fault::bad_argument,
                "a map with mean-value weights has no energy that could be polished: take cotangent "
                "or Tutte weights");
  require_sphere(surface);
  const HalfEdges half_edges(surface);
  const std::uint32_t pole = pole_vertex(surface, options.pole);
  const auto areas = vertex_areas(surface);
  const SparseMatrix laplace = laplacian(surface, half_edges, options.weights);
  check_stop(monitor);
  const Disk disk = harmonic_disk(surface, half_edges, laplace, options.weights, pole, monitor);
  check_stop(monitor);
  const double scale = options.disk_scale > 0 ? options.disk_scale : halving_scale(disk, areas, pole);

  std::vector<SpherePoint> x(disk.w.size(), SpherePoint::Zero());
  for (std::uint32_t v = 0; v < x.size(); ++v)
    if (half_edges.leaving(v) != HalfEdges::none)
      x[v] = inverse_stereographic(std::complex<long double>(disk.w[v]) * static_cast<long double>(scale));
  x[pole] = SpherePoint(0, 0, -1);

  SphereMap map;
  map.method = MapMethod::harmonic;
  const Vec3& place = surface.vertices()[pole];
  map.notes.push_back(fmt::format("vertex {} at ({:.6g}, {:.6g}, {:.6g}) was taken out and its {} neighbours, from "
                                  "vertex {} on, laid on a circle by arc length",
                                  pole, place.x(), place.y(), place.z(), disk.loop.size(), disk.loop.front()));
  map.notes.push_back(
      fmt::format("{} weights; relative residual of the harmonic system {:.1e}", name(options.weights), disk.residual));
  map.notes.push_back(fmt::format("the disk was multiplied by {:.6g}{}", scale,
                                  options.disk_scale > 0 ? "" : ", which brings half of the area to each hemisphere"));
  bool polished = false;
  if (polishes) {
    const std::vector<SpherePoint> start = x;
    try {
      const PolishReport report = polish(laplace, surface.faces(), areas, x, monitor);
      polished = true;
      map.notes.push_back(fmt::format("polished in {} steps to a relative imbalance of {:.1e}: the Dirichlet energy "
                                      "over 4 pi went from {:.9g} to {:.9g}",
                                      report.steps, std::sqrt(report.decrement),
                                      report.energy_before / (4 * std::numbers::pi),
                                      report.energy / (4 * std::numbers::pi)));
    } catch (const Error& error) {
      if (options.polish || error.fault() != Fault::map_failed) throw;
      x = start;
      map.notes.push_back(
          fmt::format("not polished, so that shear is left round the vertex taken out: {}", error.what()));
    }
  } else if (!options.polish && !polishable)
    map.notes.emplace_back(
        "not polished, so that shear is left round the vertex taken out: mean-value weights have no energy");
  if (!polished && (options.centre || polishes))
    map.notes.push_back(fmt::format("centred by a Moebius transformation in {} steps", centre(x, areas)));
  if (options.align) {
    align(x, areas, surface.vertices());
    map.notes.emplace_back("the sphere was rotated to look like the body from its middle");
  }
  map.positions = rounded(x);
  return map;
}

} // namespace cowgpu
