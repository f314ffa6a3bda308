// A rigid body on a circular orbit about a point mass: attitudes that last, librations about them, tidal locking.
//
// The orbit frame has x from the point mass to the body (outwards), y along the motion and z along the orbit's normal, and turns
// at the orbital rate n about z. The orbit is that of two points: what the multipoles do to it is left out, a part of order
// (R/r)^2.
#pragma once

#include "host/physics/point_mass.hpp"
#include "host/physics/rigid_body.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu::physics {

struct Orbit {
  double gm = 0;       ///< G M of the point mass, m^3/s^2
  double radius = 0;   ///< between the centres, m
  double rate = 0;     ///< n in rad/s: n^2 = (gm + G m)/r^3
  double gradient = 0; ///< gm/r^3; n^2 of a body without mass
};

/// Throws Error(bad_argument) for a mass or a radius that is not above 0 and finite, point_inside for a radius inside the body's
/// Brillouin sphere, where that is known.
Orbit circular_orbit(const PointMass& centre, const RigidBody& body, double radius);

/// How a motionless attitude in the orbit frame fares after a small disturbance.
enum class Stability {
  lagrange, ///< energy is least: stable, with friction too
  debra_delp, ///< stable by the gyroscopic torque alone, until friction moves it (DeBra and Delp 1961, J. Astronaut. Sci. 8, 14)
  neutral, ///< a part of the motion feels no restoring torque: an axis of symmetry
  unstable,
};
const char* name(Stability stability);

/// Small motions of a body with its principal axes along the orbit frame's, moments of inertia I_x, I_y, I_z along these. With
/// g = gradient/n^2 the pitch (about z) is s^2 = -3 g (I_y - I_x)/I_z, and roll (about x) and yaw (about y) go together,
///   s^4 + s^2 [k_y (1 + 3g) + k_x + (1 - k_x)(1 - k_y)] + k_x k_y (1 + 3g) = 0,  k_x = (I_z - I_y)/I_x, k_y = (I_z - I_x)/I_y,
/// in units of n (V. V. Beletskii, Motion of an Artificial Satellite about its Center of Mass, 1966; P. C. Hughes, Spacecraft
/// Attitude Dynamics, 1986, ch. 9).
struct Libration {
  std::array<int, 3> axes = {0, 1, 2}; ///< which principal axis, by growing moment, lies along x, y, z
  Stability stability = Stability::neutral;
  double pitch = 0; ///< rad/s; 0: it does not oscillate
  /// |Im s| in rad/s, the slower first; 0: no such oscillation. An unstable attitude has those whose s^2 is below 0 or complex:
  /// the latter grow or fade while they oscillate.
  std::array<double, 2> roll_yaw = {};
};

/// About the attitude in which principal axis axes[i] lies along axis i of the orbit frame.
Libration libration(const PrincipalAxes& principal, const Orbit& orbit, const std::array<int, 3>& axes);

/// Of a body with three different moments all attitudes at rest under degree 2 (P. W. Likins and R. E. Roberson 1966, J.
/// Astronaut. Sci. 13, 87): principal axes along those of the orbit frame. Each of these six stands for the four that half turns
/// make of it. The first is that with the least moment along x and the largest along z.
std::vector<Libration> relative_equilibria(const PrincipalAxes& principal, const Orbit& orbit);

/// Whether nothing librates: three equal moments.
bool is_isotropic(const PrincipalAxes& principal);

/// The torque that turns the body in the orbit frame, in that frame's axes: of gravity, less n^2 z cross I z, which keeps it
/// turning with the frame. `attitude` takes the body's axes to the frame's.
struct OrbitTorque {
  LongVec3 gravity = LongVec3::Zero(), rest = LongVec3::Zero();
};
OrbitTorque orbit_torque(const RigidBody& body, const Orbit& orbit, const LongMat3& attitude);

/// The attitude at rest nearest to one with principal axes along the frame's, under all degrees to body.order.
struct ShiftedEquilibrium {
  LongMat3 attitude = LongMat3::Identity();
  LongVec3 shift =
      LongVec3::Zero(); ///< the rotation from the attitude of degree 2, as a vector in the orbit frame, rad
  bool found = false;   ///< false: higher degrees are no small correction here
};
/// Newton's iteration with the slope of degree 2; `start` takes principal axes along those of the frame. Turns that degree 2
/// does not resist (an axis of symmetry) are left as they are.
ShiftedEquilibrium shifted_equilibrium(const RigidBody& body, const Orbit& orbit, const LongMat3& start);

/// 3 gm (C - A)/(2 r^3): the largest torque of degree 2 over all attitudes, at 45 degrees between the axes of A and C.
double largest_quadrupole_torque(const PrincipalAxes& principal, const Orbit& orbit);

/// Half the width of the spin rates about the normal that are caught, in rad/s: n sqrt(3 g (B - A)/C), the pitch rate on the
/// separatrix as the long axis points to the point mass (P. Goldreich and S. Peale 1966, Astron. J. 71, 425).
double capture_half_width(const PrincipalAxes& principal, const Orbit& orbit);

/// What a Love number k2 and a quality factor can be: a uniform fluid's k2 is 3/2, and no body that is known has a Q beyond.
inline constexpr double largest_love = 1.5, largest_quality = 1e12;

/// Time to lock from a spin rate, omega r^6 I Q / (3 G M^2 k2 R^5) in s (B. Gladman et al. 1996, Icarus 122, 166, eq. 9), with I
/// and R the moment and the radius of the uniform ball of the body's mass and second moment. Throws Error(bad_argument) for
/// a spin or k2 that is not above 0, k2 over largest_love, Q outside 1 to largest_quality, and a time of no computable size.
double locking_time(const RigidBody& body, const Orbit& orbit, double spin, double love, double quality);

} // namespace cowgpu::physics
