// What is found out about the gravitational waves of a body that turns.
#pragma once

#include "host/physics/findings.hpp"
#include "host/physics/radiate.hpp"
#include "host/physics/rigid_body.hpp"

#include <optional>

namespace cowgpu {

/// Squares are in the units of the body.
struct RadiationResult {
  physics::Subject subject;
  physics::RigidBody body;                  ///< about its centre of mass
  std::optional<double> longest_side;       ///< of a mesh's box, in the units of the body
  Vec3 axis = Vec3::UnitY();                ///< of length 1
  double omega = 0;                         ///< rad/s
  double time = 0;                          ///< s, from the start of the spin to when it is asked for
  double square = 0;                        ///< Q'''_ij Q'''_ij / omega^6
  std::optional<double> octupole;           ///< I''''_ijk I''''_ijk / omega^8, where asked for
  std::optional<double> current_quadrupole; ///< J'''_ij J'''_ij / omega^8, where asked for
  double spherical_difference = 0;          ///< of `square` from the formula of multipoles, over 64 Q_ij Q_ij
  std::optional<double> moment;             ///< moment of inertia about the axis, where the input says it
  long double power = 0;                    ///< W, where units are stated
  std::optional<physics::SpinDown> spin;    ///< where units are stated and the moment is known
};

/// What `cowgpu radiate` shows of it: rows, tables and notes with their units.
physics::Findings findings(const RadiationResult& result);

} // namespace cowgpu
