#include "host/map/polish.hpp"

#include "host/error.hpp"
#include "host/map/solve.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu {

namespace {

Eigen::MatrixXd as_matrix(std::span<const SpherePoint> x) {
  Eigen::MatrixXd matrix(Eigen::Index(x.size()), 3);
  for (std::size_t i = 0; i < x.size(); ++i) matrix.row(Eigen::Index(i)) = x[i].cast<double>();
  return matrix;
}

// A third of the areas of the chord triangles at each vertex.
std::vector<double> mapped_areas(const Eigen::MatrixXd& x, std::span<const Face> faces) {
  std::vector<double> areas(std::size_t(x.rows()), 0);
  for (const Face& f : faces) {
    const Vec3 a = x.row(f[0]), b = x.row(f[1]), c = x.row(f[2]);
    const double third = (b - a).cross(c - a).norm() / 6;
    for (const std::uint32_t v : f) areas[v] += third;
  }
  return areas;
}

// The part of L x along the sphere, less what would drive a Moebius transformation or a rotation of the whole: forces
// proportional to mapped areas, so that the smallest triangles feel the least of them.
Eigen::MatrixXd imbalance(const Eigen::MatrixXd& x, const Eigen::MatrixXd& pull, std::span<const Face> faces) {
  const auto areas = mapped_areas(x, faces);
  using Field = Eigen::Matrix<double, 3, 6>; // the six conformal fields at a point: (1 - x x^T) e_k and e_k x x
  const auto field = [&](Eigen::Index i) {
    const Vec3 at = x.row(i);
    Field f;
    for (int k = 0; k < 3; ++k) {
      f.col(k) = Vec3::Unit(k) - at[k] * at;
      f.col(3 + k) = Vec3::Unit(k).cross(at);
    }
    return f;
  };
  Eigen::MatrixXd result(x.rows(), 3);
  Eigen::Matrix<double, 6, 6> resistance = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> drive = Eigen::Matrix<double, 6, 1>::Zero();
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const Field f = field(i);
    result.row(i) = pull.row(i) - pull.row(i).dot(x.row(i)) * x.row(i);
    drive += f.transpose() * result.row(i).transpose();
    resistance += areas[std::size_t(i)] * f.transpose() * f;
  }
  const Eigen::Matrix<double, 6, 1> force = resistance.ldlt().solve(drive);
  for (Eigen::Index i = 0; i < x.rows(); ++i) result.row(i) -= areas[std::size_t(i)] * (field(i) * force).transpose();
  return result;
}

double inner(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.cwiseProduct(b).sum();
}

} // namespace

PolishReport polish(const SparseMatrix& laplace, std::span<const Face> faces, std::span<const double> areas,
                    std::span<SpherePoint> x, Monitor& monitor, int most_steps) {
  constexpr double wanted = 1e-26, acceptable = 1e-12, longest = 1.2;
  SparseMatrix metric = laplace;
  for (Eigen::Index i = 0; i < metric.cols(); ++i) {
    const double mass = 4 * std::numbers::pi * areas[std::size_t(i)];
    if (mass > 0)
      metric.coeffRef(i, i) += mass;
    else if (laplace.col(int(i)).nonZeros() == 0)
      metric.insert(i, i) = 1; // a vertex of no face
  }
  metric.makeCompressed();
  SymmetricSolver solver(metric, "the system of the harmonic map to the sphere", Ordering::automatic, monitor);

  centre(x, areas);
  const Eigen::MatrixXd start = as_matrix(x), pull = laplace * start;
  PolishReport report;
  report.energy = report.energy_before = inner(start, pull) / 2;
  std::vector<SpherePoint> moved(x.size());
  Eigen::MatrixXd left = imbalance(start, pull, faces), direction = solver.solve(left, Refinement::none);
  report.decrement = inner(left, direction) / report.energy;
  double length = longest;
  const double first = report.decrement;
  while (report.decrement > wanted && report.steps < most_steps) {
    check_stop(monitor);
    monitor.progress("polishing the map", std::log(first / report.decrement) / std::log(first / wanted));
    bool fell = false;
    for (length = std::min(2 * length, longest); !fell && length > longest / 20; length /= fell ? 1 : 2) {
      for (std::size_t i = 0; i < x.size(); ++i) {
        const Vec3 step = length * direction.row(Eigen::Index(i));
        moved[i] = x[i].squaredNorm() > 0 ? (x[i] - step.cast<long double>()).normalized() : x[i];
      }
      centre(moved, areas);
      const Eigen::MatrixXd next = as_matrix(moved), next_pull = laplace * next;
      const Eigen::MatrixXd next_left = imbalance(next, next_pull, faces),
                            next_direction = solver.solve(next_left, Refinement::none);
      const double energy = inner(next, next_pull) / 2, decrement = inner(next_left, next_direction) / energy;
      fell = decrement < report.decrement;
      if (!fell) continue;
      std::copy(moved.begin(), moved.end(), x.begin());
      direction = next_direction;
      report.energy = energy;
      report.decrement = decrement;
      ++report.steps;
    }
    if (!fell) break;
  }
  if (!(report.decrement <= acceptable))
    throw Error(
        Fault::map_failed,
        fmt::format("the polish of the map to the sphere stopped after {} steps at a relative imbalance of {:.1e}, "
                    "where 1e-6 is asked: the surface has triangles too thin for its weights; take the map "
                    "without polish, or the stretch map",
                    report.steps, std::sqrt(report.decrement)));
  return report;
}

} // namespace cowgpu
