#include "host/map/moebius.hpp"

#include "host/error.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {

namespace {

using Matrix = Eigen::Matrix<long double, 3, 3>;

bool present(const SpherePoint& x) {
  return x.squaredNorm() > 0;
}

SpherePoint weighted_mean(std::span<const SpherePoint> x, std::span<const double> weights) {
  SpherePoint sum = SpherePoint::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) sum += weights[i] * x[i];
  return sum;
}

} // namespace

SpherePoint inverse_stereographic(const std::complex<long double>& w) {
  const long double square = std::norm(w);
  return SpherePoint(2 * w.real(), 2 * w.imag(), 1 - square) / (1 + square);
}

SpherePoint moebius(const SpherePoint& x, const SpherePoint& c) {
  const SpherePoint sum = x + c;
  return ((1 - c.squaredNorm()) / sum.squaredNorm() * sum + c).normalized();
}

int centre(std::span<SpherePoint> x, std::span<const double> weights) {
  constexpr long double rounding = 1e-17L, wanted = 1e-14L;
  SpherePoint mean = weighted_mean(x, weights);
  std::vector<SpherePoint> moved(x.size());
  int steps = 0;
  for (; steps < 200 && mean.norm() > rounding; ++steps) {
    Matrix derivative = Matrix::Zero();
    for (std::size_t i = 0; i < x.size(); ++i)
      if (present(x[i])) derivative += 2 * weights[i] * (Matrix::Identity() - x[i] * x[i].transpose());
    SpherePoint c = -derivative.inverse() * mean;
    if (!(c.norm() <= 0.9L)) c = -0.9L * mean.normalized();
    // Shorter until the mean falls; near the end only rounding is left of it.
    bool fell = false;
    for (; !fell && c.norm() > rounding; c /= 2) {
      for (std::size_t i = 0; i < x.size(); ++i) moved[i] = present(x[i]) ? moebius(x[i], c) : x[i];
      const SpherePoint now = weighted_mean(moved, weights);
      fell = now.norm() < mean.norm();
      if (fell) {
        std::copy(moved.begin(), moved.end(), x.begin());
        mean = now;
      }
    }
    if (!fell) break;
  }
  if (!(mean.norm() <= wanted))
    throw Error(Fault::map_failed,
                fmt::format("no Moebius transformation centres the map: the mean direction stays {:.1e} long after {} "
                            "steps. Some point of the sphere holds half of the surface; try another pole, or the "
                            "stretch map",
                            double(mean.norm()), steps));
  return steps;
}

Eigen::Matrix3d align(std::span<SpherePoint> x, std::span<const double> weights, std::span<const Vec3> vertices) {
  Vec3 middle = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) middle += weights[i] * vertices[i];
  double size = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (present(x[i])) size = std::max(size, (vertices[i] - middle).lpNorm<Eigen::Infinity>());
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < x.size(); ++i)
    if (present(x[i])) moment += weights[i] * x[i].cast<double>() * ((vertices[i] - middle) / size).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moment, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d &u = svd.matrixU(), &v = svd.matrixV();
  const Eigen::Matrix3d rotation = v * Vec3(1, 1, (v * u.transpose()).determinant()).asDiagonal() * u.transpose();
  const Matrix extended = rotation.cast<long double>();
  for (SpherePoint& direction : x)
    if (present(direction)) direction = (extended * direction).normalized();
  return rotation;
}

std::vector<Vec3> rounded(std::span<const SpherePoint> x) {
  std::vector<Vec3> result(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    result[i] = present(x[i]) ? Vec3(x[i].normalized().cast<double>()) : Vec3(Vec3::Zero());
  return result;
}

} // namespace cowgpu
