#include "host/map/polish.hpp"

#include "host/error.hpp"
#include "host/map/solve.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu {

namespace {

Eigen::MatrixXd as_matrix(std::span<const Direction> x) {
  Eigen::MatrixXd matrix(Eigen::Index(x.size()), 3);
  for (std::size_t i = 0; i < x.size(); ++i) matrix.row(Eigen::Index(i)) = x[i].cast<double>();
  return matrix;
}

// The gradient along the sphere of the energy after centring: centring answers a step d by the Moebius field
// -2 (1 - x x^T) J^-1 sum(area d), J = 2 sum(area (1 - x x^T)).
Eigen::MatrixXd gradient(const Eigen::MatrixXd& x, const Eigen::MatrixXd& pull, std::span<const double> areas) {
  const auto along = [&](Eigen::Index i, const Vec3& v) -> Vec3 { return v - v.dot(x.row(i)) * x.row(i).transpose(); };
  Eigen::MatrixXd result(x.rows(), 3);
  Eigen::Matrix3d derivative = Eigen::Matrix3d::Zero();
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const double area = areas[std::size_t(i)];
    result.row(i) = along(i, pull.row(i));
    sum += result.row(i);
    derivative += 2 * area * (Eigen::Matrix3d::Identity() - x.row(i).transpose() * x.row(i));
  }
  const Vec3 multiplier = 2 * derivative.inverse() * sum;
  for (Eigen::Index i = 0; i < x.rows(); ++i) result.row(i) -= areas[std::size_t(i)] * along(i, multiplier);
  return result;
}

double inner(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.cwiseProduct(b).sum();
}

} // namespace

PolishReport polish(const SparseMatrix& laplace, std::span<const double> areas, std::span<Direction> x,
                    int most_steps) {
  constexpr double wanted = 1e-13, acceptable = 1e-10;
  SparseMatrix metric = laplace;
  for (Eigen::Index i = 0; i < metric.cols(); ++i) {
    const double mass = 4 * std::numbers::pi * areas[std::size_t(i)];
    if (mass > 0)
      metric.coeffRef(i, i) += mass;
    else if (laplace.col(int(i)).nonZeros() == 0)
      metric.insert(i, i) = 1; // a vertex of no face
  }
  metric.makeCompressed();
  SymmetricSolver solver(std::move(metric), "the system of the harmonic map to the sphere");

  centre(x, areas);
  Eigen::MatrixXd now = as_matrix(x), pull = laplace * now;
  PolishReport report;
  report.energy = report.energy_before = inner(now, pull) / 2;
  std::vector<Direction> moved(x.size());
  double length = 1;
  for (;; ++report.steps) {
    const Eigen::MatrixXd slope = gradient(now, pull, areas), direction = solver.solve(slope);
    report.decrement = inner(slope, direction) / report.energy;
    if (report.decrement <= wanted || report.steps == most_steps) break;
    bool fell = false;
    for (length = std::min(1.5 * length, 2.0); !fell && length > 1e-4; length *= fell ? 1.0 : 0.5) {
      for (std::size_t i = 0; i < x.size(); ++i) {
        const Vec3 step = length * direction.row(Eigen::Index(i));
        moved[i] = areas[i] > 0 ? (x[i] - step.cast<long double>()).normalized() : x[i];
      }
      centre(moved, areas);
      const Eigen::MatrixXd next = as_matrix(moved), next_pull = laplace * next;
      const double energy = inner(next, next_pull) / 2;
      fell = energy < report.energy;
      if (!fell) continue;
      std::copy(moved.begin(), moved.end(), x.begin());
      now = next;
      pull = next_pull;
      report.energy = energy;
    }
    if (!fell) break;
  }
  if (!(report.decrement <= acceptable))
    throw Error(Fault::map_failed,
                fmt::format("the energy of the map to the sphere still falls after {} steps ({:.1e} of it a step): the "
                            "surface has triangles too thin for its weights; take the map without polish, or the "
                            "stretch map",
                            report.steps, report.decrement));
  return report;
}

} // namespace cowgpu
