#include "host/physics/equilibrium_newton.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace cowgpu::physics {
namespace {

constexpr int most_steps = 40;
constexpr double enough = 1e-11; // of G M/R^2

struct Runner {
  std::size_t start;
  Vec3 at, best_at;
  double best = std::numeric_limits<double>::infinity();
  int worse = 0; // steps since the best
};

} // namespace

EquilibriumNewton::EquilibriumNewton(const Body& body, double constant, const Spin& spin, const Backend& backend)
    : field_(body, constant, spin, 0, backend), spin_(spin) {
  radius_ = std::cbrt(std::abs(body.volume) * 3 / (4 * std::numbers::pi));
  gravity_ = constant * std::abs(body.mass()) / (radius_ * radius_);
  density_ = std::abs(body.density);
}

std::vector<Equilibrium> EquilibriumNewton::from(std::span<const Start> starts, Monitor& monitor) const {
  std::vector<Runner> running;
  for (std::size_t i = 0; i < starts.size(); ++i) running.push_back({i, starts[i].at, starts[i].at});
  std::vector<Vec3> places;
  for (int step = 0; step < most_steps && !running.empty(); ++step) {
    std::vector<Vec3> points;
    for (const Runner& r : running) points.push_back(r.at);
    const SpinningValues values = field_.at(points, false, monitor);
    std::vector<Runner> next;
    for (std::size_t i = 0; i < running.size(); ++i) {
      Runner r = running[i];
      const Start& start = starts[r.start];
      const double size = values.acceleration[i].norm();
      if (size < r.best) {
        r.best = size;
        r.best_at = r.at;
        r.worse = 0;
      } else if (++r.worse == 3 || r.best < enough * gravity_) {
        if (r.best < enough * gravity_) places.push_back(r.best_at);
        continue;
      }
      Vec3 by = values.gradient[i].partialPivLu().solve(-values.acceleration[i]);
      if (values.on_edge[i] || !by.allFinite()) continue;
      if (by.norm() > start.reach) by *= start.reach / by.norm();
      r.at += by;
      if ((r.at - start.at).norm() > start.reach) continue;
      next.push_back(r);
    }
    running = std::move(next);
  }
  for (const Runner& r : running)
    if (r.best < enough * gravity_) places.push_back(r.best_at);
  std::vector<Vec3> apart;
  for (const Vec3& p : places)
    if (std::none_of(apart.begin(), apart.end(), [&](const Vec3& q) { return (p - q).norm() < 1e-9 * radius_; }))
      apart.push_back(p);
  std::vector<Equilibrium> found;
  if (apart.empty()) return found;
  const SpinningValues values = field_.at(apart, true, monitor);
  for (std::size_t i = 0; i < apart.size(); ++i) {
    Equilibrium e;
    e.at = apart[i];
    e.jacobi = values.geopotential[i];
    e.residual = values.acceleration[i].norm();
    e.inside = values.density[i] > 1e-6 * density_;
    e.density = e.inside ? values.density[i] : 0;
    e.depth = values.depth[i];
    e.gradient = values.gradient[i];
    e.motions = small_motions(e.gradient, spin_.axis, spin_.rate);
    found.push_back(e);
  }
  return found;
}

} // namespace cowgpu::physics
