#include "host/physics/drop.hpp"

#include "host/error.hpp"
#include "host/physics/extrapolation.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace cowgpu::physics {
namespace {

using Real = long double;

// Where the departures from the start stand in the state. The angular momentum and both attitudes are those of the body relative to
// its attitude at the start: (1 + w, v) turns the body's axes then to now.
enum Slot : Eigen::Index { place = 0, velocity = 3, momentum = 6, w = 9, v = 10, free_w = 13, free_v = 14, size = 17 };

class Fall {
public:
  explicit Fall(const DropProblem& problem)
      : problem_(problem), ground_(problem.planet.radius), start_(ground_ + problem.height),
        attitude_(problem.attitude), inertia_(problem.body.inertia().cast<Real>()), inverse_(inertia_.inverse()),
        spin_(inertia_ * problem.spin.cast<Real>()),
        least_moment_(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(problem.body.inertia()).eigenvalues()[0]) {
    for (const Vec3& p : problem.vertices) reach_ = std::max<Real>(reach_, p.norm());
  }

  State slope(const State& y) const {
    State rate(size);
    const LongVec3 r = from_planet(y);
    const LongMat3 turn = rotation_of(y[w], y.segment<3>(v));
    const Pull p = pull_at(r, turn);
    const Real gm = problem_.planet.gm, distance = r.norm();
    const LongVec3 higher = attitude_ * (turn * p.force) / problem_.body.mass;
    rate.segment<3>(place) = y.segment<3>(velocity);
    rate.segment<3>(velocity) = -gm / (distance * distance * distance) * r + higher;
    rate.segment<3>(momentum) = turn * p.torque;
    turn_rate(y, w, LongVec3(spin_ + y.segment<3>(momentum)), rate);
    turn_rate(y, free_w, spin_, rate);
    return rate;
  }

  // The body's axes at the start to those now.
  LongMat3 attitude(const State& y) const { return attitude_ * rotation_of(y[w], y.segment<3>(v)); }

  LongVec3 from_planet(const State& y) const { return LongVec3(0, start_, 0) + y.segment<3>(place); }

  // Above the ground: |p| - ground without its cancellation.
  Real height(const State& y, const LongMat3& turn, const Vec3& vertex) const {
    const LongVec3 s = LongVec3(0, problem_.height, 0) + y.segment<3>(place) + turn * vertex.cast<Real>();
    const Real more = 2 * ground_ * s.y() + s.squaredNorm();
    return more / (std::sqrt(ground_ * ground_ + more) + ground_);
  }

  struct Lowest {
    std::size_t vertex = 0;
    Real height = 0;
  };
  Lowest lowest(const State& y) const {
    const LongMat3 turn = attitude(y);
    Lowest least{0, height(y, turn, problem_.vertices[0])};
    for (std::size_t i = 1; i < problem_.vertices.size(); ++i)
      if (const Real h = height(y, turn, problem_.vertices[i]); h < least.height) least = {i, h};
    return least;
  }

  std::size_t count_below(const State& y, Real level) const {
    const LongMat3 turn = attitude(y);
    return std::size_t(std::count_if(problem_.vertices.begin(), problem_.vertices.end(),
                                     [&](const Vec3& p) { return height(y, turn, p) <= level; }));
  }

  // A time in which no point of the body gets `way` further down: speeds grow at most like now + growth t.
  Real safe_time(const State& y, Real way) const {
    const Real low = ground_ > 0 ? ground_ : start_, gravity = Real(problem_.planet.gm) / (low * low);
    const Real radius = reach_, now = y.segment<3>(velocity).norm() + rim_speed(y) * (1 + 1e-3L);
    const Real growth = gravity + 3 * gravity / low * radius;
    return 2 * way / (now + std::sqrt(now * now + 4 * growth * way));
  }

  // No vertex of a free body ever moves faster about its centre: the energy bounds what its spin can become.
  Real rim_speed(const State& y) const {
    const LongVec3 spin = angular_velocity(y);
    return std::sqrt(spin.dot(inertia_ * spin) / least_moment_) * reach_;
  }

  Real landing_speed(Real way) const { return std::sqrt(2 * way * Real(problem_.planet.gm) / start_ / (start_ - way)); }

  // Sizes, for what is exactly or nearly nothing, by what a long rod would do in the time that the fall takes.
  std::vector<Block> blocks() const {
    const Real gm = problem_.planet.gm, time = radial_fall_time(gm, start_, problem_.height);
    const Real rate = 0.03L * gm / (start_ * start_ * start_) * time, turn = rate * time;
    const Real moment = problem_.body.inertia().trace(), speed = rate * moment / (problem_.body.mass * start_);
    return {{{place + 1}},
            {{place, place + 2}, speed * time},
            {{velocity + 1}},
            {{velocity, velocity + 2}, speed},
            {{momentum, momentum + 1, momentum + 2}, rate * moment},
            {{w}, turn * turn},
            {{v, v + 1, v + 2}, turn},
            {{free_w}},
            {{free_v, free_v + 1, free_v + 2}}};
  }

  LongVec3 angular_velocity(const State& y) const {
    const LongMat3 turn = rotation_of(y[w], y.segment<3>(v));
    return inverse_ * (turn.transpose() * (spin_ + y.segment<3>(momentum)));
  }

  // Energy above that at the start, its monopole part by the difference of the distances.
  Real energy_gain(const State& y) const {
    const LongVec3 d = y.segment<3>(place);
    const Real r = from_planet(y).norm(), farther = (2 * start_ * d.y() + d.squaredNorm()) / (r + start_);
    const Real mass = problem_.body.mass, gm = problem_.planet.gm;
    const LongMat3 turn = rotation_of(y[w], y.segment<3>(v));
    // Rotational: (L + l).w/2 - L.w0/2 with the parts that both have left out.
    const LongVec3 old = inverse_ * spin_, spin = angular_velocity(y);
    const Real rotation = (spin.dot(inertia_ * spin) - old.dot(spin_)) / 2;
    const Real higher =
        pull_at(from_planet(y), turn).energy - pull_at(LongVec3(0, start_, 0), LongMat3::Identity()).energy;
    return kinetic(y) + gm * mass * farther / (r * start_) + rotation + higher;
  }
  Real kinetic(const State& y) const { return problem_.body.mass * y.segment<3>(velocity).squaredNorm() / 2; }

  Real spin_energy() const { return spin_.dot(inverse_ * spin_) / 2; }

  // What gravity's gradient brings a rod of the body's size in that time.
  Real tidal_momentum(Real time) const {
    return 1.5L * Real(problem_.planet.gm) / (start_ * start_ * start_) * inertia_.trace() * time;
  }

  struct Momentum {
    LongVec3 change;
    Real largest;
  };
  Momentum momentum_gain(const State& y) const {
    const LongVec3 orbital = problem_.body.mass * from_planet(y).cross(LongVec3(y.segment<3>(velocity)));
    const LongVec3 own = attitude_ * y.segment<3>(momentum);
    return {orbital + own, std::max(orbital.norm(), own.norm())};
  }

  Pull pull_at(const LongVec3& r, const LongMat3& turn) const {
    return pull(problem_.body, problem_.planet.gm, -(turn.transpose() * (attitude_.transpose() * r)));
  }

  Real start() const { return start_; }
  Real reach() const { return reach_; }
  const LongMat3& inverse() const { return inverse_; }

private:
  // (1 + w, v)' = (1 + w, v) (0, omega)/2.
  void turn_rate(const State& y, Eigen::Index slot, const LongVec3& momentum_now, State& rate) const {
    const Real scalar = y[slot];
    const LongVec3 vector = y.segment<3>(slot + 1);
    const LongVec3 omega = inverse_ * (rotation_of(scalar, vector).transpose() * momentum_now);
    rate[slot] = -vector.dot(omega) / 2;
    rate.segment<3>(slot + 1) = ((1 + scalar) * omega + vector.cross(omega)) / 2;
  }

  const DropProblem& problem_;
  Real ground_, start_;
  LongMat3 attitude_, inertia_, inverse_;
  LongVec3 spin_; // angular momentum at the start, in the body's axes then
  Real least_moment_, reach_ = 0;
};

// The relative turn of two attitudes: vector part of (1 + w, v) conj(1 + f, u) as a rotation vector.
LongVec3 relative_turn(const State& y) {
  const Real a = 1 + y[w], b = 1 + y[free_w];
  const LongVec3 p = y.segment<3>(v), q = y.segment<3>(free_v);
  const LongVec3 sine = b * p - a * q - p.cross(q);
  const Real cosine = a * b + p.dot(q), length = sine.norm();
  return length > 0 ? LongVec3(sine / length * (2 * std::atan2(length, cosine))) : sine;
}

constexpr double fastest_rim = 1000, most_turns = 1e4;

void check_height(const DropProblem& problem) {
  if (problem.vertices.empty()) throw Error(Fault::bad_argument, "a body without a surface has no lowest point");
  if (!std::isfinite(problem.height) || !(problem.height > 0))
    throw Error(Fault::bad_argument,
                fmt::format("the height is {} m; it is that of the centre of mass above the ground and must be above 0",
                            problem.height));
  if (problem.height > 1e6 * problem.planet.radius)
    throw Error(Fault::bad_argument,
                fmt::format("a height of {} m is too far from a ground of radius {} m: give a lower --height",
                            problem.height, problem.planet.radius));
  if (problem.planet.hill_radius > 0 && problem.planet.radius + problem.height > problem.planet.hill_radius)
    throw Error(Fault::bad_argument,
                fmt::format("a height of {:.6g} m is outside the {}'s Hill sphere, {:.4g} m, where nothing falls to it "
                            "alone: give a lower --height",
                            problem.height, problem.planet.name, problem.planet.hill_radius));
}

void check_spin(const Fall& fall, const State& start, Real way, Real time) {
  const Real speed = fall.rim_speed(start), falls = fall.landing_speed(way);
  if (speed > fastest_rim * falls)
    throw Error(
        Fault::bad_argument,
        fmt::format("the spin moves the body's rim at {:.3g} m/s, more than {} times as fast as it falls from here "
                    "({:.3g} m/s): lower --spin",
                    double(speed), fastest_rim, double(falls)));
  const Real turns = speed / fall.reach() * time / (2 * std::numbers::pi_v<Real>);
  if (turns > most_turns)
    throw Error(Fault::bad_argument,
                fmt::format("the body turns {:.3g} times as it falls for {:.3g} s, and more than {:.0e} turns are not "
                            "followed: lower --spin or --height",
                            double(turns), double(time), most_turns));
}

} // namespace

LongMat3 rotation_of(long double w, const LongVec3& v) {
  const Real s = 1 + w, norm = s * s + v.squaredNorm();
  LongMat3 cross;
  cross << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return LongMat3::Identity() + 2 / norm * (s * cross + cross * cross);
}

long double radial_fall_time(long double gm, long double r, long double d) {
  const Real part = d / r;
  return std::sqrt(r / (2 * gm)) * r * (std::asin(std::sqrt(part)) + std::sqrt(part * (1 - part)));
}

DropResult drop(const DropProblem& problem, Monitor& monitor) {
  check_height(problem);
  const Fall fall(problem);
  State y = State::Zero(size);
  Fall::Lowest least = fall.lowest(y);
  DropResult result;
  result.depth = double(problem.height - least.height);
  if (!(least.height > 0))
    throw Error(
        Fault::bad_argument,
        fmt::format("at a height of {} m the body touches the ground already: its lowest point is {:.6g} m under "
                    "its centre of mass; give a larger --height",
                    problem.height, result.depth));
  const Real whole = radial_fall_time(problem.planet.gm, fall.start(), least.height);
  check_spin(fall, y, least.height, whole);
  result.torque = fall.pull_at(LongVec3(0, fall.start(), 0), LongMat3::Identity()).torque;
  Real done = 0; // trial steps go back
  const Slope slope = [&](Real now, const State& s) {
    check_stop(monitor);
    done = std::max(done, now);
    monitor.progress("falling", std::min(1.0, double(done / whole)));
    return fall.slope(s);
  };
  const Real close = 1e-13L * (problem.height + fall.reach());
  const std::vector<Block> blocks = fall.blocks();
  Real step = 0, t = 0;
  while (least.height > close) {
    check_stop(monitor);
    const Real time = fall.safe_time(y, least.height);
    y = extrapolate(slope, y, t, t + time, blocks, step);
    t += time;
    least = fall.lowest(y);
  }
  result.time = t;
  const LongVec3 r = fall.from_planet(y), d = y.segment<3>(place);
  result.fallen = -(2 * fall.start() * d.y() + d.squaredNorm()) / (r.norm() + fall.start());
  result.kepler_time = radial_fall_time(problem.planet.gm, fall.start(), result.fallen);
  result.speed = double(y.segment<3>(velocity).norm());
  result.attitude = fall.attitude(y);
  result.turn = problem.attitude * relative_turn(y);
  result.first_order = problem.attitude * (fall.inverse() * result.torque) * (t * t / 2);
  result.touching = least.vertex;
  result.as_low = fall.count_below(y, least.height + 1e-9L * fall.reach());
  result.energy_drift = std::abs(fall.energy_gain(y)) / (fall.kinetic(y) + fall.spin_energy());
  const Fall::Momentum momentum = fall.momentum_gain(y);
  result.momentum_drift = momentum.change.norm() / std::max(momentum.largest, fall.tidal_momentum(t));
  return result;
}

} // namespace cowgpu::physics
