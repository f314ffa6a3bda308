// The pull of a point mass on a body: force and torque from its multipoles about its centre of mass.
#pragma once

#include "host/mesh/body.hpp"
#include "host/monitor.hpp"
#include "host/multipoles.hpp"
#include "host/physics/tensors.hpp"

#include <Eigen/Core>

#include <memory>
#include <string>

namespace cowgpu::reference {
template <class Real>
class ExteriorPotential; // host/reference/potential.hpp
}

namespace cowgpu::physics {

using LongVec3 = Eigen::Matrix<long double, 3, 1>;
using LongMat3 = Eigen::Matrix<long double, 3, 3>;

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

/// A rigid body as a point mass far away feels it: SI, about the centre of mass, in the body's own axes.
struct MassiveBody {
  double mass = 0;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d quadrupole = Eigen::Matrix3d::Zero();
  double radius = 0; ///< radius of the Brillouin sphere, which the point mass must be outside of; as in MassTensors
  bool radius_known = true;                                                ///< the same
  int order = 2;                                                           ///< the last degree that counts
  std::shared_ptr<const reference::ExteriorPotential<long double>> higher; ///< degrees 3 to `order`; null where 2
};

/// Degrees 3 and more of `moments`, in kg m^l, and what else is in `tensors`, about the centre of mass in SI. Throws
/// Error(file_format) without a second moment, Error(bad_argument) for a mass or a moment of inertia that is not above 0.
MassiveBody massive_body(const MassTensors& tensors, Multipoles moments, int order);

/// Of a mesh in metres and kilograms about its centre of mass, with exact moments to `order` >= 2. Throws
/// Error(bad_argument) for a body without mass.
MassiveBody massive_body(const Body& body, int order, Monitor& monitor);

/// Of coefficients; `tensors` are theirs in SI about their own origin, `unit_m` and `unit_kg` their units. Throws
/// Error(file_format) without a second moment, and for an order above 2 where the set ends before, or where its origin is not
/// the centre of mass to 1e-6 of the radius: its higher degrees are then those about another point.
MassiveBody massive_body(const CoefficientSet& set, const MassTensors& tensors, double unit_m, double unit_kg,
                         int order);

/// What a point mass at x (from the centre of mass, in the body's axes) does to the body, in its axes, by degrees 2 and
/// more; the pull of degree 0, G M m x/|x|^3, is not in it and gives no torque. With V the integral of density(y)/|x - y|
/// without that degree
///   force = -G M grad V(x),  torque = -G M x cross grad V(x),  energy = -G M V(x);
/// of degree 2 V = x.Q.x / (2 |x|^5), and the torque is 3 G M x cross I x / |x|^5.
struct Pull {
  LongVec3 force = LongVec3::Zero(), torque = LongVec3::Zero();
  long double energy = 0;
};
Pull pull(const MassiveBody& body, long double gm, const LongVec3& x);

} // namespace cowgpu::physics
