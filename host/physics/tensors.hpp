// Mass, centre and second moments of a body, of a mesh or from multipoles of degree 0 to 2; principal axes.
#pragma once

#include "host/coefficient_set.hpp"
#include "host/mesh/body.hpp"

#include <Eigen/Core>

#include <array>
#include <complex>
#include <optional>
#include <string>

namespace cowgpu::physics {

/// About `origin`, in the body's axes.
struct MassTensors {
  double mass = 0;
  Vec3 first_moment = Vec3::Zero();                     ///< integral of density x, x from the origin
  Eigen::Matrix3d quadrupole = Eigen::Matrix3d::Zero(); ///< integral of density (3 x_i x_j - r^2 delta_ij)
  std::optional<double> trace;                          ///< integral of density r^2; coefficients may lack it
  std::optional<Vec3> origin;                           ///< in mesh coordinates
  std::string origin_kind;                              ///< "centre of mass", "mesh", "given", or empty
  double radius = 0; ///< radius of a sphere about the origin that holds the body; where not known the reference radius,
  bool radius_known = true;                                ///< which says how large the body may be, and no more
  std::string length_unit = std::string(mesh_length_unit); ///< "m" where metric
  std::string mass_unit = std::string(mesh_mass_unit);     ///< "kg" where metric

  bool metric() const { return length_unit == "m" && mass_unit == "kg"; }
  /// integral of density x_i x_j = (quadrupole + trace)/3; Error(file_format) without the trace.
  Eigen::Matrix3d second_moment() const;
  /// integral of density (r^2 delta_ij - x_i x_j) = (2 trace - quadrupole)/3; the same error.
  Eigen::Matrix3d inertia() const;
};

/// Of a mesh with its parts, about the body's origin (host/mesh/tensors.hpp).
MassTensors mass_tensors(const Body& body);

/// Throws Error(file_format) for coefficients of a surface or of another field that is no mass.
void check_mass_multipoles(const CoefficientSet& set);

/// Of mass multipoles or a potential, to degree 2, in any convention: with Y_lm as in SphereCoefficients
///   Q_20 = sqrt(5/16pi) Q_zz,  Q_21 = -sqrt(5/24pi) (Q_xz + i Q_yz),  Q_22 = sqrt(5/96pi) (Q_xx - Q_yy + 2i Q_xy).
/// Throws Error(file_format) for coefficients of a surface and for degrees that end before 2; what converted() throws.
MassTensors mass_tensors(const CoefficientSet& set);

/// Q_20, Q_21, Q_22 of a tensor, by the same equations, not conjugated.
std::array<std::complex<double>, 3> spherical_quadrupole(const Eigen::Matrix3d& quadrupole);

/// The same body about its centre of mass (Steiner). Throws Error(bad_argument) where the mass is 0, or so near that there is
/// no such centre.
MassTensors about_centre(const MassTensors& tensors);

/// Throws Error(bad_argument) where the mass or a moment of inertia, about the centre of mass, is not above 0.
void check_weighs(const MassTensors& centred);

/// The same body in metres and kilograms: lengths times `metres`, masses times `kilograms`.
MassTensors in_si(const MassTensors& tensors, double metres, double kilograms);

/// The axes as columns of a rotation matrix, by growing moment of inertia. Of the first two the largest component (the first
/// of those within 1e-9 of it) is positive; the third is the first cross the second.
struct PrincipalAxes {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Vec3 quadrupole = Vec3::Zero(); ///< along them, falling
  std::optional<Vec3> moments;    ///< moments of inertia, rising; with the trace only
  bool first_two_alike = false;   ///< to 1e-9 of the largest quadrupole: any two axes in their plane would do
  bool last_two_alike = false;
};

PrincipalAxes principal_axes(const MassTensors& tensors);

} // namespace cowgpu::physics
