// A rigid body that falls to the ground of a spherical planet without air, turned by the gradient of gravity.
#pragma once

#include "host/monitor.hpp"
#include "host/physics/point_mass.hpp"

#include <cstddef>
#include <span>

namespace cowgpu::physics {

/// At the start the body's centre of mass is at rest in an inertial frame whose origin is that centre, y upwards, the planet's
/// centre at (0, -(ground + height), 0). The planet is a point mass that stays where it is.
struct DropProblem {
  RigidBody body;
  PointMass planet = earth;
  double height = 0;                        ///< height of the centre of mass above the ground, m
  LongMat3 attitude = LongMat3::Identity(); ///< from the body's axes to the inertial ones
  Vec3 spin = Vec3::Zero();                 ///< angular velocity in the body's axes, rad/s
  std::span<const Vec3> vertices;           ///< surface that touches, from the centre of mass, in the body's axes, m
};

struct DropResult {
  double depth = 0;            ///< lowest point under the centre of mass at the start, as height above the ground goes
  long double time = 0;        ///< s, until the lowest point is on the ground
  long double fallen = 0;      ///< way of the centre of mass towards the planet's, m
  long double kepler_time = 0; ///< that a point takes to fall as far: closed form
  double speed = 0;            ///< speed of the centre of mass at the end, m/s
  LongMat3 attitude = LongMat3::Identity(); ///< at the end
  LongVec3 turn =
      LongVec3::Zero(); ///< from the attitude that the spin alone would have led to, as a rotation vector in the
                        ///< inertial frame, rad; right to its last digits however small
  LongVec3 first_order =
      LongVec3::Zero(); ///< I^-1 torque t^2/2 of the torque at the start, in the inertial frame: the same for a
                        ///< body at rest, to the first order
  LongVec3 torque = LongVec3::Zero(); ///< at the start, in the body's axes, N m
  std::size_t touching = 0;           ///< the vertex that touches
  std::size_t as_low = 0;             ///< how many are as low, to 1e-9 of the largest distance of a vertex
  long double energy_drift = 0; ///< change of energy over the kinetic at the end with that of the spin at the start
  long double momentum_drift =
      0; ///< change of the angular momentum about the planet's centre that gravity has brought, over the
         ///< largest of its parts, but at least over what it brings a rod of this body's size
};

/// Integrates position, momentum, attitude (a quaternion) and angular momentum by extrapolate(), all as departures from the
/// start, until the first vertex touches the sphere of the ground: no time step is longer than the body needs to reach it.
/// Throws Error(bad_argument) for a height at which the body touches already, or that is not finite, over 1e6 radii of the
/// ground or beyond the planet's Hill sphere, for a body without vertices, and for a spin that moves its vertices more than
/// 1000 times faster than it falls, or turns it more than 1e4 times, which takes too many steps; interrupted.
DropResult drop(const DropProblem& problem, Monitor& monitor = silent_monitor());

/// Time in s of a radial fall from rest at r over the distance d < r:
/// sqrt(r^3/(2 gm)) (asin sqrt(d/r) + sqrt(d/r (1 - d/r))).
long double radial_fall_time(long double gm, long double r, long double d);

/// A rotation given by a quaternion (1 + w, v), whether it is of length 1 or not.
LongMat3 rotation_of(long double w, const LongVec3& v);

} // namespace cowgpu::physics
