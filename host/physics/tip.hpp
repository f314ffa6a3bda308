// The force that begins to tip a standing body over onto its side, after "Higher multipoles of the cow": x forward, y up, z to
// the right; the body turns about an axis along x, and only torque about x counts.
//
// All points lie in the plane x = b_x through the barycentre b. The pivot p is the support point farthest to the side that the
// body falls to, projected along x. The ray q goes from p through b, and p_T is the last point where it meets the surface. The
// push F acts there in the direction n at right angles to q and x. With d = |p_z - b_z|, r = |b - p|, L = |p_T - p| and the
// weight w:
//   about p: ground and friction act at p and have no torque: F L = w d.
//   about b: ground N = w - F n_y with n_y = d/r, arm d, against F at arm |p_T - b|. As the paper writes it,
//            F |p_T - b| = N d, it leaves out the friction F n_z = F h/r at arm h = b_y - p_y, which helps the push. With it
//            F (|p_T - b| + h^2/r) = (w - F d/r) d, that is F (|p_T - b| + r) = w d: the balance about p again.
// So the paper's force is too large by (|p_T - b| + r)/(|p_T - b| + d^2/r). Taken literally, in space and not in the plane, its
// arm |(p - b) x y| counts a fore-aft offset too, which gives no torque about x.
#pragma once

#include "host/mesh/triangle_surface.hpp"
#include "host/monitor.hpp"
#include "host/physics/feet.hpp"
#include "host/physics/push.hpp"
#include "host/physics/rigid_body.hpp"
#include "host/physics/settle.hpp"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace cowgpu::physics {

inline constexpr double standard_gravity = 9.80665; ///< m/s^2

/// A closed triangulation of a smooth surface as a body of uniform density with this mass: regions count by the winding
/// number, and what is inside out as a whole is turned; `note` says so. Throws what ClosedSurface::from() and make_body()
/// throw.
RigidBody smooth_body(const TriangleSurface& surface, double mass, std::string& note);

/// A ball with this body's centre and mass and so large a volume, smooth, standing on one of its vertices as modelled.
RigidBody ball_like(const RigidBody& body, double volume);

/// How a body is stood on the ground.
struct StandOptions {
  bool as_modelled = false;     ///< else it settles first
  double contact_tolerance = 0; ///< what is no higher above the ground touches it, in the body's unit
};

/// A body on the ground, its own axes those of the world, y up: turned about the origin of its coordinates.
struct Stance {
  RigidBody body;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero(); ///< about the centre of mass
  Attitude attitude;
  Contact contact;
  std::vector<Foot> feet; ///< feet of a smooth body
  bool held = false; ///< the barycentre is over the patch sideways but not fore and aft: something else must hold it
};

/// Stands a body that has a surface, in any units. Throws Error(cannot_stand) where the barycentre lies beside the contact patch, and what settle() throws.
Stance stand(RigidBody body, const StandOptions& options, const Monitor& monitor = silent_monitor());

/// The side that a body falls to: z is its right.
enum class Side { left, right };
std::string name(Side side);

/// What begins to tip a body over to one side; forces in units of its weight.
struct Tipping {
  Side side = Side::right;
  bool rolls = false; ///< a smooth body whose outermost foot is under the barycentre: it rolls over it, and d = 0
  Vec3 support = Vec3::Zero();   ///< the support point that the pivot is the projection of
  Vec3 pivot = Vec3::Zero();     ///< p
  Vec3 point = Vec3::Zero();     ///< p_T
  Vec3 direction = Vec3::Zero(); ///< direction of the push
  double offset = 0;             ///< d
  double height = 0;             ///< h
  double radius = 0;             ///< r
  double lever = 0;              ///< L
  double force = 0;              ///< about the pivot
  double force_paper_balance = 0;
  std::optional<double> force_paper_literal; ///< none where its ray in space meets nothing
  double friction_needed = 0;                ///< coefficient below which the feet slip before the body tips
  double inertia = 0;                        ///< about the axis along x through p (Steiner)

  /// The angle from which it falls on by itself.
  double balance_angle() const;
  /// The push under which feet of this friction coefficient slip, F n_z = mu (w - F n_y).
  double slip_force(double mu) const;
};

/// Throws Error(cannot_stand) where the ray q meets no surface (a barycentre outside the body, and nothing beyond).
Tipping tipping(const Stance& stance, Side side);

/// The same as a body that is pushed for a while, in SI.
Rocker rocker(double mass, const Tipping& tipping, double gravity, bool turns_with_body);

/// The side that needs less; the right where both need the same to 1e-12.
Side weaker_side(const Tipping& left, const Tipping& right);

/// The largest t > 0 for which start + t direction lies on the surface, to 1e-12 of each triangle; nothing where there is
/// none. O(faces).
std::optional<double> last_hit(const RigidBody& body, const Vec3& start, const Vec3& direction);

} // namespace cowgpu::physics
