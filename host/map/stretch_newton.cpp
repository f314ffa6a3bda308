#include "host/map/stretch_newton.hpp"

#include "host/map/canonical_surface.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cowgpu {

namespace {
constexpr double no_bound = std::numeric_limits<double>::infinity();
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

// The lower triangle of the Hessian of a sum over faces, as it is and with each face's part made positive: the values of
// two sparse matrices of one pattern.
class Hessians {
public:
  Hessians(const std::vector<Face>& faces, std::size_t vertex_count) {
    const auto size = Eigen::Index(2 * vertex_count);
    std::vector<Eigen::Triplet<double>> entries;
    for (const Face& face : faces)
      for_entries(face, [&](Eigen::Index row, Eigen::Index column, int, int) { entries.emplace_back(row, column, 0); });
    matrix.resize(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    matrix.makeCompressed();
    exact.resize(matrix.nonZeros());
    positive.resize(matrix.nonZeros());
    for (const Face& face : faces)
      for_entries(face, [&](Eigen::Index row, Eigen::Index column, int, int) {
        slots_.push_back(std::size_t(&matrix.coeffRef(row, column) - matrix.valuePtr()));
      });
  }

  void clear() {
    exact.setZero();
    positive.setZero();
    next_ = slots_.data();
  }
  /// Of the next face, in the order of the faces.
  void add(const Face& face, const Matrix6& hessian) {
    Matrix6 made = hessian;
    make_positive(made);
    for_entries(face, [&](Eigen::Index, Eigen::Index, int i, int j) {
      exact[Eigen::Index(*next_)] += hessian(i, j);
      positive[Eigen::Index(*next_++)] += made(i, j);
    });
  }

  Eigen::SparseMatrix<double> matrix;
  Eigen::ArrayXd exact, positive;

private:
  template <class Function>
  static void for_entries(const Face& face, Function&& f) {
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i) {
        const auto row = Eigen::Index(2 * face[i / 2] + i % 2), column = Eigen::Index(2 * face[j / 2] + j % 2);
        if (row >= column) f(row, column, i, j);
      }
  }
  std::vector<std::size_t> slots_;
  const std::size_t* next_ = nullptr;
};

class Newton {
public:
  Newton(const StretchSum& sum, std::vector<Vec3>& positions)
      : sum_(sum), x_(positions), trial_(positions), frames_(positions.size()),
        hessians_(sum.faces(), positions.size()) {
    energy_ = sum_.energy(x_);
    solver_.analyzePattern(hessians_.matrix);
  }

  NewtonResult run(Monitor& monitor) {
    constexpr unsigned most_steps = 500;
    NewtonResult result;
    while (result.steps < most_steps && !result.converged) {
      check_stop(monitor);
      monitor.progress("minimising the stretch", double(result.steps) / most_steps);
      differentiate();
      factorise();
      if (!step(result.converged)) break;
      ++result.steps;
    }
    return result;
  }

private:
  void differentiate() {
    for (std::size_t v = 0; v < x_.size(); ++v) frames_[v] = tangent_frame(x_[v]);
    gradient_.setZero(Eigen::Index(2 * x_.size()));
    hessians_.clear();
    const auto& faces = sum_.faces();
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const auto d =
          stretch_derivatives(sum_.weights()[f], {frames_[faces[f][0]], frames_[faces[f][1]], frames_[faces[f][2]]});
      for (int i = 0; i < 3; ++i) gradient_.segment<2>(Eigen::Index(2 * faces[f][i])) += d.gradient.segment<2>(2 * i);
      hessians_.add(faces[f], d.hessian);
    }
  }

  // Far from the minimum the Hessian is not positive definite. The sum of the faces' positive parts is, but so much
  // larger that steps become short: as little of it is mixed in as does.
  void factorise() {
    for (;;) {
      auto& matrix = hessians_.matrix;
      Eigen::Map<Eigen::ArrayXd>(matrix.valuePtr(), matrix.nonZeros()) =
          mixed_in_ * hessians_.positive + (1 - mixed_in_) * hessians_.exact;
      // Turning the whole sphere changes nothing: the Hessian has three zero eigenvalues. Far from the minimum more is
      // added: a matrix that is hardly definite makes steps that rounding decides.
      for (Eigen::Index i = 0; i < matrix.cols(); i += 2) { // a column begins with its diagonal
        const auto p = matrix.outerIndexPtr()[i], q = matrix.outerIndexPtr()[i + 1];
        const double shift = (near_ ? 1e-8 : 1e-3) * (hessians_.positive[p] + hessians_.positive[q]);
        matrix.valuePtr()[p] += shift;
        matrix.valuePtr()[q] += shift;
      }
      solver_.factorize(matrix);
      if ((solver_.info() == Eigen::Success && solver_.vectorD().minCoeff() > 0) || mixed_in_ >= 1) break;
      mixed_in_ = std::min(1.0, 2 * mixed_in_ + 0.01);
    }
  }

  // Energy after a part of the move; the positions are in trial_.
  double try_part(const Eigen::VectorXd& move, double t) {
    for (std::size_t v = 0; v < x_.size(); ++v) {
      const Eigen::Vector2d d = t * move.segment<2>(2 * Eigen::Index(v));
      trial_[v] = (x_[v] + frames_[v].topRows<2>().transpose() * d).normalized();
    }
    return sum_.energy(trial_);
  }

  // False if the energy does not fall.
  bool step(bool& converged) {
    const Eigen::VectorXd move = -solver_.solve(gradient_);
    const double slope = gradient_.dot(move) / sphere_area; // slope of the energy, negative
    converged = -slope < 1e-13 * energy_;
    near_ = near_ || -slope < 1e-6 * energy_;
    double longest = 0; // in any frames
    for (Eigen::Index i = 0; i < move.size(); i += 2) longest = std::max(longest, move.segment<2>(i).norm());
    double t = longest > 0.5 ? 0.5 / longest : 1, energy = try_part(move, t);
    for (int halvings = 0; !(energy <= energy_ + 1e-4 * t * slope); ++halvings) {
      if (halvings == 50) return false;
      energy = try_part(move, t /= 2);
    }
    if (t == 1) // what was mixed in may have made it short
      while (2 * t * longest <= 0.5) {
        const double farther = try_part(move, 2 * t);
        if (!(farther < energy)) break;
        energy = farther;
        t *= 2;
      }
    if (t < 0.25)
      mixed_in_ = std::min(1.0, 2 * mixed_in_ + 0.01);
    else
      mixed_in_ = mixed_in_ < 1e-3 ? 0 : mixed_in_ / 3;
    energy_ = try_part(move, t);
    x_.swap(trial_);
    return true;
  }

  const StretchSum& sum_;
  std::vector<Vec3>& x_;
  std::vector<Vec3> trial_;
  double energy_ = 0;
  bool near_ = false;     // to the minimum
  double mixed_in_ = 0.5; // how much of the faces' positive parts
  std::vector<Frame> frames_;
  Hessians hessians_;
  Eigen::VectorXd gradient_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

} // namespace

NewtonResult minimise_stretch(const StretchSum& sum, std::vector<Vec3>& positions, Monitor& monitor) {
  return Newton(sum, positions).run(monitor);
}

} // namespace cowgpu
