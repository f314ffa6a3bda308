// Gravity as it is felt on a body that spins: geopotential, slope, elevation, escape speed.
//
// In the frame that turns with the body, at a place r from a point of the spin axis, with omega = rate times axis:
//   g = G grad V - omega x (omega x r),   geopotential = -G V - |omega x r|^2/2,   g = -grad geopotential,
// V = integral of density/|x - r| (D. J. Scheeres et al., Dynamics of orbits close to asteroid 4179 Toutatis, Icarus 132 (1998)
// 53; R. A. Werner and D. J. Scheeres, Celest. Mech. Dyn. Astron. 65 (1997) 313).
#pragma once

#include "host/physics/potential.hpp"
#include "host/physics/rigid_body.hpp"
#include "host/physics/surface_places.hpp"
#include "host/potential.hpp"
#include "host/types.hpp"

#include <vector>

namespace cowgpu::physics {

/// A steady turn. A rate of 0 is none.
struct Spin {
  double rate = 0;             ///< rad/s; where no units are stated in units of sqrt(G density)
  Vec3 axis = Vec3::UnitZ();   ///< of length 1
  Vec3 through = Vec3::Zero(); ///< a point of the axis
};

/// The axis of the largest moment of inertia of a body about its centre of mass, its largest component positive. Throws Error(bad_argument) where the two
/// largest moments are equal: a ball and a needle have no such axis.
Vec3 largest_principal_axis(const Body& body);

/// One entry a place; what needs a normal is empty at points.
struct SurfaceGravity {
  std::vector<double> potential;    ///< of the attraction alone, -G V
  std::vector<Vec3> gravity;        ///< g, the centrifugal acceleration in it
  std::vector<double> geopotential; ///< potential less |omega x r|^2/2
  std::vector<double> slope;        ///< angle between -g and the normal, 0 to pi; 0 where g or the normal is 0
  /// (geopotential less its mean over the surface, by area)/|g|: positive where water would flow away; NaN where g is 0.
  std::vector<double> elevation;
  std::vector<double> escape_speed; ///< sqrt(2 G V): to leave for ever, seen from outside; 0 where V is not above 0
  std::vector<double>
      tilt; ///< angle between the normal and the way from the centre of mass, 0 to pi; 0 where either is 0
  double mean_geopotential = 0; ///< by area; 0 at points
};

/// `field` has V and its gradient at the places.
SurfaceGravity surface_gravity(const SurfacePlaces& places, const PotentialField& field, const FieldLaw& law,
                               const Spin& spin, const Vec3& centre_of_mass);

} // namespace cowgpu::physics
