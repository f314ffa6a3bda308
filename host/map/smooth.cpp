#include "host/map/smooth.hpp"

#include "host/error.hpp"
#include "host/map/laplacian.hpp"
#include "host/map/moebius.hpp"
#include "host/map/solve.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cowgpu {

namespace {

// Its ordering takes longer and its factors less, and one ordering serves some thirty factors here.
constexpr std::size_t nested_dissection_from_here = 40000;

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

// To area 1 about the centre of mass of the surface.
void normalise(Eigen::MatrixXd& x, const std::vector<Face>& faces) {
  Vec3 middle = Vec3::Zero();
  double total = 0;
  for (const Face& f : faces) {
    const double part = twice_area(x, f) / 2;
    total += part;
    for (const std::uint32_t v : f) middle += part / 3 * x.row(v).transpose();
  }
  x.rowwise() -= (middle / total).transpose();
  x /= std::sqrt(total);
}

// Mean radius, and its root mean square deviation over it, by the areas that x has.
struct Radii {
  double mean = 0, deviation = 0;
};

Radii radii(const Eigen::MatrixXd& x, const std::vector<Face>& faces) {
  double weight = 0, first = 0, second = 0;
  for (const Face& f : faces) {
    const double part = twice_area(x, f);
    for (const std::uint32_t v : f) {
      const double radius = x.row(v).norm();
      weight += part;
      first += part * radius;
      second += part * radius * radius;
    }
  }
  const double mean = first / weight;
  return {mean, std::sqrt(std::max(0.0, second / weight - mean * mean)) / mean};
}

// Root mean square by area of what a step is besides the Moebius field (1 - y y^T) c, y = x / |x|, that fits it best.
double movement(const Eigen::MatrixXd& from, const Eigen::MatrixXd& to, std::span<const double> areas) {
  const auto projector = [&](Eigen::Index i) -> Eigen::Matrix3d {
    const Vec3 y = to.row(i).normalized();
    return Eigen::Matrix3d::Identity() - y * y.transpose();
  };
  Eigen::Matrix3d resistance = Eigen::Matrix3d::Zero();
  Vec3 drive = Vec3::Zero();
  for (Eigen::Index i = 0; i < to.rows(); ++i) {
    const Eigen::Matrix3d weighted = areas[std::size_t(i)] * projector(i);
    resistance += weighted;
    drive += weighted * (to.row(i) - from.row(i)).transpose();
  }
  const Vec3 fit = resistance.ldlt().solve(drive);
  double sum = 0;
  for (Eigen::Index i = 0; i < to.rows(); ++i) {
    const Vec3 step = (to.row(i) - from.row(i)).transpose();
    sum += areas[std::size_t(i)] * (step - projector(i) * fit).squaredNorm();
  }
  return std::sqrt(sum);
}

} // namespace

SphereMap smooth_map(const ManifoldSurface& surface, const SmoothOptions& options, Monitor& monitor) {
  if (!(options.first_step > 0 && options.largest_step > 0 && options.settled > 0 && options.roundness > 0 &&
        options.most_steps > 0))
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
  normalise(x, faces);
  std::optional<SymmetricSolver> solver;
  double step = options.first_step, moved = std::numeric_limits<double>::infinity();
  Radii now;
  int steps = 0;
  double first = 0; // movement of the first step
  for (; steps < options.most_steps && !(moved <= options.settled * now.mean); ++steps) {
    check_stop(monitor);
    if (steps > 0) {
      const double wanted = options.settled * now.mean;
      monitor.progress("smoothing the surface",
                       std::clamp(std::log(first / moved) / std::log(first / wanted), 0.0, 1.0));
    }
    const SparseMatrix mass = mass_matrix(x, faces, laplace);
    const SparseMatrix system = mass + step * laplace;
    if (solver)
      solver->factorise(system);
    else
      solver.emplace(system, "the system of the mean-curvature flow",
                     std::size_t(x.rows()) < nested_dissection_from_here ? Ordering::minimum_degree
                                                                         : Ordering::nested_dissection,
                     monitor);
    Eigen::MatrixXd next = solver->solve(mass * x);
    normalise(next, faces);
    // Short steps move little without being near the end.
    moved = movement(x, next, areas) * std::max(1.0, options.largest_step / step);
    if (steps == 0) first = moved;
    x = std::move(next);
    now = radii(x, faces);
    step = std::min(2 * step, options.largest_step);
  }
  if (!(moved <= options.settled * now.mean && now.deviation <= options.roundness))
    throw Error(Fault::map_failed,
                fmt::format("the mean-curvature flow did not become a sphere: after {} steps it moves by {:.1e} of the "
                            "mean radius a step (asked for: {:.1e}), and radii differ by {:.1e} (asked for: {:.1e}); "
                            "take the stretch map, or the harmonic one",
                            steps, moved / now.mean, options.settled, now.deviation, options.roundness));

  std::vector<SpherePoint> directions(surface.vertices().size(), SpherePoint::Zero());
  for (std::uint32_t v = 0; v < directions.size(); ++v)
    if (half_edges.leaving(v) != HalfEdges::none)
      directions[v] = SpherePoint(x.row(v).transpose().cast<long double>()).normalized();
  SphereMap map;
  map.method = MapMethod::smooth;
  map.notes.push_back(fmt::format("mean-curvature flow settled in {} steps (the last moved {:.1e}) to a sphere whose "
                                  "radii differ by {:.1e} of their mean",
                                  steps, moved / now.mean, now.deviation));
  map.notes.push_back(fmt::format("centred by a Moebius transformation in {} steps", centre(directions, areas)));
  if (options.align) {
    align(directions, areas, surface.vertices());
    map.notes.emplace_back("the sphere was rotated to look like the body from its middle");
  }
  map.positions = rounded(directions);
  return map;
}

} // namespace cowgpu
