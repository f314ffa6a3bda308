#include "host/map/stretch_newton.hpp"

#include "host/map/canonical_surface.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <cmath>
#include <numbers>

namespace cowgpu {

namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double sphere_area = 4 * std::numbers::pi;
} // namespace

StretchSum::StretchSum(std::span<const Vec3> points, const std::vector<std::vector<std::uint32_t>>& rings,
                       double lambda) {
  for_each_face(rings, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    faces_.push_back({a, b, c});
    weights_.push_back(stretch_weights(points[a], points[b], points[c], lambda));
  });
}

double StretchSum::energy(std::span<const Vec3> x) const {
  double sum = 0;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Face& face = faces_[f];
    sum += stretch_energy(weights_[f], x[face[0]], x[face[1]], x[face[2]]);
  }
  return sum / sphere_area;
}

std::vector<Vec3> StretchSum::gradient(std::span<const Vec3> x) const {
  std::vector<Vec3> gradient(x.size(), Vec3::Zero());
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    std::array<Frame, 3> frames;
    for (int i = 0; i < 3; ++i) frames[i] = tangent_frame(x[faces_[f][i]]);
    const auto slopes = stretch_derivatives(weights_[f], frames).gradient;
    for (int i = 0; i < 3; ++i)
      gradient[faces_[f][i]] += frames[i].topRows<2>().transpose() * slopes.segment<2>(2 * i) / sphere_area;
  }
  return gradient;
}

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

// The nearest positive semidefinite matrix.
void make_positive(Matrix6& hessian) {
  Eigen::SelfAdjointEigenSolver<Matrix6> eigen(hessian);
  if (eigen.eigenvalues()[0] >= 0) return;
  hessian = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
}

class Newton {
public:
  Newton(const StretchSum& sum, std::vector<Vec3>& positions) : sum_(sum), x_(positions), trial_(positions) {
    energy_ = sum_.energy(x_);
    frames_.resize(x_.size());
  }

  NewtonResult run(Monitor& monitor) {
    constexpr unsigned most_steps = 300;
    NewtonResult result;
    while (result.steps < most_steps && !result.converged) {
      check_stop(monitor);
      monitor.progress("minimising the stretch", double(result.steps) / most_steps);
      const double before = energy_;
      const bool moved = step(result.converged);
      if (!moved) break;
      ++result.steps;
      exact_ = before - energy_ < 1e-3 * energy_; // near the minimum only
    }
    return result;
  }

private:
  bool step(bool& converged) {
    for (std::size_t v = 0; v < x_.size(); ++v) frames_[v] = tangent_frame(x_[v]);
    if (!(exact_ && factorise(true)) && !factorise(false)) return false;
    const Eigen::VectorXd move = -solver_.solve(gradient_);
    const double slope = gradient_.dot(move) / sphere_area; // of the energy, negative
    converged = -slope < 1e-13 * energy_;
    double t = std::min(1.0, 0.5 / std::max(1e-300, move.lpNorm<Eigen::Infinity>()));
    for (int halvings = 0; halvings < 50; ++halvings, t /= 2) {
      for (std::size_t v = 0; v < x_.size(); ++v) {
        const Eigen::Vector2d d = t * move.segment<2>(2 * Eigen::Index(v));
        trial_[v] = (x_[v] + frames_[v].topRows<2>().transpose() * d).normalized();
      }
      const double energy = sum_.energy(trial_);
      if (!(energy <= energy_ + 1e-4 * t * slope)) continue;
      energy_ = energy;
      x_.swap(trial_);
      return true;
    }
    return false;
  }

  // The Hessian, each face's made positive unless `exact`; false if it is not positive definite.
  bool factorise(bool exact) {
    const auto size = Eigen::Index(2 * x_.size());
    gradient_.setZero(size);
    entries_.clear();
    const auto& faces = sum_.faces();
    for (std::size_t f = 0; f < faces.size(); ++f) {
      StretchDerivatives d =
          stretch_derivatives(sum_.weights()[f], {frames_[faces[f][0]], frames_[faces[f][1]], frames_[faces[f][2]]});
      if (!exact) make_positive(d.hessian);
      for (int i = 0; i < 6; ++i) {
        const auto row = Eigen::Index(2 * faces[f][i / 2] + i % 2);
        gradient_[row] += d.gradient[i];
        for (int j = 0; j < 6; ++j) {
          const auto column = Eigen::Index(2 * faces[f][j / 2] + j % 2);
          if (row >= column) entries_.emplace_back(row, column, d.hessian(i, j));
        }
      }
    }
    hessian_.resize(size, size);
    hessian_.setFromTriplets(entries_.begin(), entries_.end());
    // Turning the whole sphere changes nothing: the Hessian has three zero eigenvalues.
    for (Eigen::Index i = 0; i < size; ++i) hessian_.coeffRef(i, i) *= 1 + 1e-8;
    if (!analysed_) solver_.analyzePattern(hessian_);
    analysed_ = true;
    solver_.factorize(hessian_);
    return solver_.info() == Eigen::Success && solver_.vectorD().minCoeff() > 0;
  }

  const StretchSum& sum_;
  std::vector<Vec3>& x_;
  std::vector<Vec3> trial_;
  double energy_ = 0;
  bool exact_ = false, analysed_ = false;
  std::vector<Frame> frames_;
  Eigen::VectorXd gradient_;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::SparseMatrix<double> hessian_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

} // namespace

NewtonResult minimise_stretch(const StretchSum& sum, std::vector<Vec3>& positions, Monitor& monitor) {
  return Newton(sum, positions).run(monitor);
}

} // namespace cowgpu
