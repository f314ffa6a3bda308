// A rigid body as every application sees it, made from a mesh or from the coefficients of its mass.
#pragma once

#include "host/coefficient_set.hpp"
#include "host/mesh/body.hpp"
#include "host/monitor.hpp"
#include "host/multipoles.hpp"
#include "host/units.hpp"

#include <Eigen/Core>

#include <array>
#include <complex>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu::reference {
template <class Real>
class ExteriorPotential; // host/reference/potential.hpp
}

namespace cowgpu::physics {

/// Mass and moments about `origin`, in the body's axes: in SI where its units are stated, else in those of its file.
struct RigidBody {
  Units units;
  double mass = 0;
  Vec3 centre = Vec3::Zero();       ///< centre of mass in the body's coordinates, where they are known
  Vec3 first_moment = Vec3::Zero(); ///< integral of density x, x from the origin
  Eigen::Matrix3d quadrupole = Eigen::Matrix3d::Zero(); ///< integral of density (3 x_i x_j - r^2 delta_ij)
  std::optional<double> trace;                          ///< integral of density r^2; coefficients may lack it
  std::optional<Vec3> origin;                           ///< in the body's coordinates; coefficients may lack it
  std::string origin_kind;                              ///< "centre of mass", "mesh", "given", or empty
  /// Radius of a sphere about the origin that holds the body. Where `radius_known` is false, the reference radius of its
  /// file, which says no more than how large the body may be.
  double radius = 0;
  bool radius_known = true;

  int order = 2; ///< the last degree of the moments that counts
  std::shared_ptr<const reference::ExteriorPotential<long double>> higher; ///< degrees 3 to `order`; null where 2

  std::vector<Vec3> vertices; ///< surface of what is solid, in the body's coordinates; empty where nothing needs it
  std::vector<Face> faces;
  bool smooth = false; ///< the triangles stand for a smooth surface: one that touches at a single point rolls there

  /// integral of density x_i x_j = (quadrupole + trace)/3; Error(file_format) without the trace.
  Eigen::Matrix3d second_moment() const;
  /// integral of density (r^2 delta_ij - x_i x_j) = (2 trace - quadrupole)/3; the same error.
  Eigen::Matrix3d inertia() const;
};

/// A mesh with its parts, to degree 2 about its origin (host/mesh/tensors.hpp).
RigidBody rigid_body(const Body& body);

/// Throws Error(file_format) for coefficients of a surface or of another field that is no mass.
void check_mass_multipoles(const CoefficientSet& set);

/// The body of mass multipoles or of a potential, to degree 2, in any convention: with Y_lm as in SphereCoefficients
///   Q_20 = sqrt(5/16pi) Q_zz,  Q_21 = -sqrt(5/24pi) (Q_xz + i Q_yz),  Q_22 = sqrt(5/96pi) (Q_xx - Q_yy + 2i Q_xy).
/// `units` are those that are stated of the set: its numbers come to SI by its unit of length and the cube of that, its
/// density being in them already. Throws Error(file_format) for coefficients of a surface and for degrees that end before
/// 2; what converted() throws.
RigidBody rigid_body(const CoefficientSet& set, const Units& units = {});

/// Q_20, Q_21, Q_22 of a tensor, by the same equations, not conjugated.
std::array<std::complex<double>, 3> spherical_quadrupole(const Eigen::Matrix3d& quadrupole);

/// The same body about its centre of mass (Steiner). Throws Error(bad_argument) where the mass is 0, or so near that there is
/// no such centre.
RigidBody about_centre(RigidBody body);

/// Throws Error(bad_argument) where the mass or a moment of inertia, about the centre of mass, is not above 0.
void check_weighs(const RigidBody& centred);

/// A body about its centre of mass with degrees 3 to `order` of `moments`, which are in its units. Throws Error(file_format)
/// without a second moment, Error(bad_argument) for a mass or a moment of inertia that is not above 0.
RigidBody with_moments(RigidBody centred, Multipoles moments, int order);

/// A mesh about its centre of mass, which is its origin, with exact moments to `order` >= 2. Throws Error(bad_argument) for a
/// body without mass.
RigidBody free_body(const Body& body, int order, Monitor& monitor);

/// The same of coefficients with their `units`. Throws Error(file_format) without a second moment, and for an order above 2
/// where the set ends before, or where its origin is not the centre of mass to 1e-6 of the radius: its higher degrees are
/// then those about another point.
RigidBody free_body(const CoefficientSet& set, const Units& units, int order);

/// A mesh about its centre of mass with the surface of what is solid: parts whose density is not above 0 are holes, which
/// nothing stands on. Throws what about_centre() and check_weighs() throw.
RigidBody solid_body(const Body& body);

/// The axes as columns of a rotation matrix, by growing moment of inertia. Each of the first two has its largest component
/// positive (where components are alike to 1e-9, the first of them); the third is the first cross the second.
struct PrincipalAxes {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Vec3 quadrupole = Vec3::Zero(); ///< along them, falling
  std::optional<Vec3> moments;    ///< moments of inertia, rising; with the trace only
  bool first_two_alike = false;   ///< to 1e-9 of the largest quadrupole: any two axes in their plane would do
  bool last_two_alike = false;
};

PrincipalAxes principal_axes(const RigidBody& body);

} // namespace cowgpu::physics
