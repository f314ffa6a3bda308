// What is found out about a body on a circular orbit.
#pragma once

#include "host/physics/findings.hpp"
#include "host/physics/tides.hpp"

#include <optional>
#include <vector>

namespace cowgpu {

/// How far the degrees above 2 turn a stable attitude.
struct AttitudeShift {
  int outwards = 1,
      normal = 1; ///< 1: the axis of the least moment points outwards, that of the largest along the normal; -1: away
  physics::ShiftedEquilibrium found;
};

struct TidesResult {
  physics::Subject subject;
  physics::RigidBody body; ///< about its centre of mass
  physics::PrincipalAxes principal;
  physics::PointMass centre;
  physics::Orbit orbit;
  physics::LongMat3 attitude;                     ///< body's axes to the orbit's
  physics::OrbitTorque torque, torque_quadrupole; ///< in that attitude, of all degrees and of degree 2
  bool isotropic = false;                         ///< three equal moments: nothing librates or locks
  physics::Libration stable;
  double largest_torque = 0;                  ///< N m
  double capture_half_width = 0;              ///< rad/s; 0 where isotropic
  std::optional<bool> caught;                 ///< where a spin is given
  std::optional<double> locking_time;         ///< s, where all that it takes is given
  std::vector<physics::Libration> equilibria; ///< none where isotropic
  std::vector<AttitudeShift> shifts;          ///< none without degrees above 2
};

/// What `cowgpu tides` shows of it: rows, tables and notes with their units.
physics::Findings findings(const TidesResult& result);

} // namespace cowgpu
