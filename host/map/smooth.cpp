#include "host/map/smooth.hpp"

#include "host/error.hpp"
#include "host/map/laplacian.hpp"
#include "host/map/moebius.hpp"
#include "host/map/solve.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace cowgpu {

namespace {

double twice_area(const Eigen::MatrixXd& x, const Face& f) {
  const Vec3 a = x.row(f[0]), b = x.row(f[1]), c = x.row(f[2]);
  return (b - a).cross(c - a).norm();
}

// The mass matrix of linear elements on the pattern of `pattern`: area / 6 on the diagonal and area / 12 beside it from
// each triangle; 1 for vertices of no face.
SparseMatrix mass_matrix(const Eigen::MatrixXd& x, const std::vector<Face>& faces, const SparseMatrix& pattern) {
  SparseMatrix mass = pattern;
  std::fill_n(mass.valuePtr(), mass.nonZeros(), 0.0);
  for (const Face& f : faces) {
    const double part = twice_area(x, f) / 24;
    for (const std::uint32_t i : f)
      for (const std::uint32_t j : f) mass.coeffRef(int(i), int(j)) += i == j ? 2 * part : part;
  }
  return mass;
}

// To area 1 about the centre of mass of the surface; returns how far from round that is.
double normalise(Eigen::MatrixXd& x, const std::vector<Face>& faces) {
  Vec3 middle = Vec3::Zero();
  double total = 0;
  for (const Face& f : faces) {
    const double part = twice_area(x, f) / 2;
    total += part;
    for (const std::uint32_t v : f) middle += part / 3 * x.row(v).transpose();
  }
  x.rowwise() -= (middle / total).transpose();
  x /= std::sqrt(total);
  double least = 1e300, most = 0, sum = 0;
  std::size_t count = 0;
  for (const Face& f : faces)
    for (const std::uint32_t v : f) {
      const double radius = x.row(v).norm();
      least = std::min(least, radius);
      most = std::max(most, radius);
      sum += radius;
      ++count;
    }
  const double mean = sum / double(count);
  return std::max(most / mean - 1, 1 - least / mean);
}

} // namespace

SphereMap smooth_map(const ManifoldSurface& surface, const SmoothOptions& options) {
  if (!(options.first_step > 0 && options.largest_step > 0 && options.roundness > 0 && options.most_steps > 0))
    throw Error(Fault::bad_argument, "the steps, the roundness and the number of steps of smoothing must be positive");
  require_sphere(surface);
  const HalfEdges half_edges(surface);
  const auto& faces = surface.faces();
  const auto areas = vertex_areas(surface);
  SparseMatrix laplace = laplacian(surface, half_edges, EdgeWeights::cotangent);
  for (int v = 0; v < laplace.cols(); ++v)
    if (areas[std::size_t(v)] == 0 && half_edges.leaving(std::uint32_t(v)) == HalfEdges::none) laplace.insert(v, v) = 1;
  laplace.makeCompressed();

  Eigen::MatrixXd x(Eigen::Index(surface.vertices().size()), 3);
  for (Eigen::Index i = 0; i < x.rows(); ++i) x.row(i) = surface.vertices()[std::size_t(i)] - surface.vertices()[0];
  x /= x.cwiseAbs().maxCoeff();
  double off = normalise(x, faces), step = options.first_step;
  std::optional<SymmetricSolver> solver;
  int steps = 0;
  for (; steps < options.most_steps && !(off <= options.roundness); ++steps) {
    const SparseMatrix mass = mass_matrix(x, faces, laplace);
    SparseMatrix system = mass + step * laplace;
    if (solver)
      solver->factorise(std::move(system));
    else
      solver.emplace(std::move(system), "the system of the mean-curvature flow");
    x = solver->solve(mass * x);
    off = normalise(x, faces);
    step = std::min(2 * step, options.largest_step);
  }
  if (!(off <= options.roundness))
    throw Error(
        Fault::map_failed,
        fmt::format("the mean-curvature flow did not become a sphere: after {} steps radii differ by {:.1e} of "
                    "their mean, where {:.1e} is asked; allow more steps or less roundness, or take the harmonic "
                    "map",
                    steps, off, options.roundness));

  std::vector<Direction> directions(surface.vertices().size(), Direction::Zero());
  for (std::uint32_t v = 0; v < directions.size(); ++v)
    if (half_edges.leaving(v) != HalfEdges::none)
      directions[v] = Direction(x.row(v).transpose().cast<long double>()).normalized();
  SphereMap map;
  map.method = "smooth";
  map.notes.push_back(
      fmt::format("mean-curvature flow became a sphere in {} steps: radii differ by {:.1e} of their mean", steps, off));
  map.notes.push_back(fmt::format("centred by a Moebius transformation in {} steps", centre(directions, areas)));
  if (options.align) {
    align(directions, areas, surface.vertices());
    map.notes.emplace_back("the sphere was rotated to look like the body from its middle");
  }
  map.positions = rounded(directions);
  return map;
}

} // namespace cowgpu
