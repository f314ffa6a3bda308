// What is found out about a body that is dropped.
#pragma once

#include "host/physics/drop.hpp"
#include "host/physics/findings.hpp"

namespace cowgpu {

/// A body lands on its feet where their direction is within so many degrees of down as it touches.
inline constexpr double lands_within = 45;

struct DropOutcome {
  physics::Subject subject;
  physics::RigidBody body;                ///< about its centre of mass
  double height = 0;                      ///< height of the centre of mass, m
  Vec3 spin = Vec3::Zero();               ///< rad/s, in the body's axes
  Vec3 feet = Vec3::Zero();               ///< where they are, in the body's axes
  Vec3 touch = Vec3::Zero();              ///< point that touches, from the centre of mass in the body's axes
  double tilt_before = 0, tilt_after = 0; ///< degrees of the feet's direction from down
  physics::DropResult fall;

  bool lands_on_its_feet() const { return tilt_after <= lands_within; }
};

/// What `cowgpu drop` shows of it: rows, tables and notes with their units.
physics::Findings findings(const DropOutcome& outcome);

} // namespace cowgpu
