// A push that lasts: whether a body on its pivot edge tips over or falls back.
//
// The body turns as a rigid one about the edge along x through p (host/physics/tip.hpp), tilted by theta >= 0 from where it
// stands, I its moment of inertia about the edge, r the distance of the barycentre, alpha the angle at which that is right
// above the edge, L the lever of the push:
//   I theta'' = F(t) L c(theta) - m g r sin(alpha - theta),
// c = 1 where the push turns with the body (at right angles to the line from p to p_T always) and cos theta where its direction
// stays in space. It lifts off once F L > m g r sin alpha, the threshold of tip.hpp; past alpha it falls by itself; where it
// comes back to theta = 0 it lands and stays until the push lifts it again. The edge does not slip: friction_needed says what
// that takes.
#pragma once

#include "host/monitor.hpp"

#include <vector>

namespace cowgpu::physics {

/// SI units.
struct Rocker {
  double mass = 0, gravity = 0;
  double inertia = 0; ///< I
  double radius = 0;  ///< r
  double balance = 0; ///< alpha, 0 to pi/2
  double lever = 0;   ///< L
  bool turns_with_body = true;

  /// m g r sin(alpha)/L: a push below never lifts it, one above that lasts always tips it.
  double threshold() const;
  /// m g r (1 - cos alpha), of the lift to the balance, in J.
  double least_energy() const;
  /// Of a push too short to move it while it lasts: J L = I omega and I omega^2/2 = least_energy().
  double least_impulse() const;
  /// How long a constant push must last; infinite up to the threshold. It ends at the tilt theta_1 whose work is what is
  /// needed in all, F L theta_1 (or sin theta_1) = m g r (1 - cos alpha), and the time there is the integral of
  /// d theta/omega, by adaptive Gauss-Kronrod quadrature to 1e-13.
  double least_duration(double force, const Monitor& monitor = silent_monitor()) const;
  /// The force that just tips it within a time above 0: where least_duration() is that, by bisection to the last digit.
  double least_force(double duration, const Monitor& monitor = silent_monitor()) const;
};

/// A force over time: straight lines between these points, jumps where a time occurs twice, 0 before and after. Times rise
/// from 0 on, forces are not negative.
struct Profile {
  std::vector<double> time, force; ///< s, N

  /// In N s.
  double impulse() const;
};

Profile square_pulse(double force, double duration);

/// Throws Error(bad_argument) for a profile that is empty, of unlike lengths, or breaks what is said there, and for an impulse
/// that is no finite number.
void check(const Profile& profile);

enum class Outcome { never_lifted, fell_back, tipped };

struct PushResult {
  Outcome outcome = Outcome::never_lifted;
  double lift_time = 0; ///< when it first left the ground; NaN if it never did
  double end_time = 0;  ///< when it passed alpha, or landed for the last time; infinite if the two cannot be told apart
  double peak_tilt = 0; ///< radians; alpha if it tipped
  double friction_needed =
      0;                    ///< largest |friction|/normal force at the edge; infinite where the edge leaves the ground
  double friction_time = 0; ///< when
};

/// Dormand and Prince's method of order 5(4), `tolerance` the error of a step relative to theta and omega, of those
/// at least alpha/1000 and sqrt(m g r/I) alpha/1000. It ends where the body tips; where the push has ended, energy decides.
/// Throws Error(bad_argument) as check() does, and for a rocker that has no threshold: alpha, lever, mass and inertia above
/// 0; Error(check_failed) where a straight piece of the push takes more than two million steps; interrupted.
PushResult push(const Rocker& rocker, const Profile& profile, const Monitor& monitor = silent_monitor());

} // namespace cowgpu::physics
