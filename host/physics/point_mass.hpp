// The pull of a point mass on a body: force and torque from its multipoles about its centre of mass.
#pragma once

#include "host/physics/rigid_body.hpp"

#include <Eigen/Core>

#include <string>

namespace cowgpu::physics {

using LongVec3 = Eigen::Matrix<long double, 3, 1>;
using LongMat3 = Eigen::Matrix<long double, 3, 3>;

/// Rotation by an angle in degrees about an axis of length 1; multiples of 90 about x, y and z are exact.
LongMat3 turn_about(const Vec3& axis, double degrees);

/// A mass that pulls, known best by its product with G.
struct PointMass {
  std::string name;       ///< "earth", or empty
  double gm = 0;          ///< m^3/s^2
  double radius = 0;      ///< radius of the ground in m; 0: a point
  double hill_radius = 0; ///< in m; farther out what it orbits itself pulls things off; 0: it is alone
  double mass() const { return gm / gravitational_constant_si; } ///< kg
};

/// Nominal GM of earth and sun (IAU 2015 resolution B3), GM of the moon in DE440 (Park et al. 2021, Astron. J. 161, 105);
/// mean radius of the earth; Hill radius au (GM/(3 GM of the sun))^(1/3).
inline const PointMass earth{"earth", 3.986004e14, 6371e3, 1.4966e9};
inline const PointMass moon{"moon", 4.902800118e12, 1737.4e3};
inline const PointMass sun{"sun", 1.3271244e20, 695700e3};

/// What a point mass at x (from the centre of mass, in the body's axes) does to a body about its centre of mass, in its axes
/// and in SI, by degrees 2 and more; the pull of degree 0, G M m x/|x|^3, is not in it and gives no torque. With V the integral of density(y)/|x - y|
/// without that degree
///   force = -G M grad V(x),  torque = -G M x cross grad V(x),  energy = -G M V(x);
/// of degree 2 V = x.Q.x / (2 |x|^5), and the torque is 3 G M x cross I x / |x|^5.
struct Pull {
  LongVec3 force = LongVec3::Zero(), torque = LongVec3::Zero();
  long double energy = 0;
};
Pull pull(const RigidBody& body, long double gm, const LongVec3& x);

} // namespace cowgpu::physics
