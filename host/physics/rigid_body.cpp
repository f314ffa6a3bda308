#include "host/physics/rigid_body.hpp"

#include "host/error.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/mesh/tensors.hpp"
#include "host/physics/potential.hpp"
#include "host/reference/potential.hpp"
#include "host/spectrum/convert.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace cowgpu::physics {
namespace {

constexpr double pi = std::numbers::pi;

double known_trace(const RigidBody& body) {
  if (body.trace) return *body.trace;
  throw Error(Fault::file_format,
              "these coefficients do not say the body's second moment (the integral of density r^2), and no multipole "
              "holds it: there is no inertia without it; take the file that `cowgpu expand -o FILE.json` writes, or "
              "what `cowgpu convert` makes of that");
}

void orient(Eigen::Ref<Vec3> axis) {
  const double largest = axis.cwiseAbs().maxCoeff();
  Eigen::Index at = 0;
  while (std::abs(axis[at]) < largest * (1 - 1e-9)) ++at;
  if (axis[at] < 0) axis = -axis;
}

// Numbers in the units of a file come to metres and kilograms.
void to_si(RigidBody& body, double metres, double kilograms) {
  body.mass *= kilograms;
  body.first_moment *= kilograms * metres;
  body.quadrupole *= kilograms * metres * metres;
  if (body.trace) *body.trace *= kilograms * metres * metres;
  if (body.origin) *body.origin *= metres;
  body.centre *= metres;
  body.radius *= metres;
}

void append(RigidBody& body, const ClosedSurface& surface) {
  const auto first = static_cast<std::uint32_t>(body.vertices.size());
  body.vertices.insert(body.vertices.end(), surface.vertices().begin(), surface.vertices().end());
  for (const Face& face : surface.faces()) body.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
}

} // namespace

Eigen::Matrix3d RigidBody::second_moment() const {
  return (quadrupole + known_trace(*this) * Eigen::Matrix3d::Identity()) / 3;
}

Eigen::Matrix3d RigidBody::inertia() const {
  return (2 * known_trace(*this) * Eigen::Matrix3d::Identity() - quadrupole) / 3;
}

RigidBody rigid_body(const Body& body) {
  const Tensors own = tensors(body);
  RigidBody result;
  result.units = body.units();
  result.mass = body.mass();
  result.centre = body.centre_of_mass;
  long double x[3] = {};
  const auto add = [&](double mass, const Vec3& centre) {
    for (int c = 0; c < 3; ++c) x[c] += (long double)(mass) * ((long double)(centre[c]) - body.origin[c]);
  };
  add(body.density * body.volume, body.parts.empty() ? body.centre_of_mass : centre_of_mass(body.surface));
  for (const Part& part : body.parts) add(part.mass(), part.centre_of_mass);
  result.first_moment = {double(x[0]), double(x[1]), double(x[2])};
  result.quadrupole = own.quadrupole;
  result.trace = own.second_moment.trace();
  result.origin = body.origin;
  result.origin_kind = body.origin_kind;
  result.radius = body.brillouin_radius;
  return result;
}

void check_mass_multipoles(const CoefficientSet& set) {
  if (set.kind == CoefficientKind::field || set.fields != 1)
    throw Error(
        Fault::file_format,
        "these are coefficients of a surface or of another field, and this asks for those of a mass: multipoles "
        "or a potential, as `cowgpu expand --of mass` and `cowgpu convert --kind multipoles` write them");
}

RigidBody rigid_body(const CoefficientSet& set, const Units& units) {
  check_mass_multipoles(set);
  if (set.lmax < 2)
    throw Error(Fault::file_format,
                fmt::format("these coefficients end at degree {}, and the quadrupole is degree 2", set.lmax));
  ConversionTarget target;
  target.kind = CoefficientKind::multipoles;
  target.lmax = 2;
  const CoefficientSet low = converted(set, target);
  if (!low.reference_radius) throw Error(Fault::file_format, "these coefficients do not say their reference radius");
  const SphereCoefficients q = orthonormal(low);
  const double r = *low.reference_radius;
  RigidBody result;
  result.units = units;
  result.mass = set.mass ? *set.mass : std::sqrt(4 * pi) * q.at(0, 0, 0).real();
  const double dipole = r / std::sqrt(3 / (4 * pi));
  result.first_moment = {-std::sqrt(2.0) * dipole * q.at(0, 1, 1).real(),
                         -std::sqrt(2.0) * dipole * q.at(0, 1, 1).imag(), dipole * q.at(0, 1, 0).real()};
  const double zz = r * r / std::sqrt(5 / (16 * pi)) * q.at(0, 2, 0).real();
  const std::complex<double> z = -r * r / std::sqrt(5 / (24 * pi)) * q.at(0, 2, 1);
  const std::complex<double> xy = r * r / std::sqrt(5 / (96 * pi)) * q.at(0, 2, 2);
  result.quadrupole << (xy.real() - zz) / 2, xy.imag() / 2, z.real(), //
      xy.imag() / 2, (-xy.real() - zz) / 2, z.imag(),                 //
      z.real(), z.imag(), zz;
  result.trace = set.second_moment;
  result.origin = set.origin;
  result.origin_kind = set.origin_kind;
  result.radius = set.brillouin_radius.value_or(r);
  result.radius_known = set.brillouin_radius.has_value();
  result.centre = result.origin.value_or(Vec3::Zero()) + result.first_moment / result.mass;
  if (units.metre != 1) to_si(result, units.metre, std::pow(units.metre, 3));
  if (!std::isfinite(result.mass) || !std::isfinite(result.radius) || !result.quadrupole.allFinite() ||
      !std::isfinite(result.trace.value_or(0)))
    throw Error(Fault::bad_argument,
                fmt::format("in units of {} m mass and moments of these coefficients are beyond the range of doubles; "
                            "state another --length-unit",
                            units.metre));
  return result;
}

std::array<std::complex<double>, 3> spherical_quadrupole(const Eigen::Matrix3d& q) {
  return {std::sqrt(5 / (16 * pi)) * q(2, 2), -std::sqrt(5 / (24 * pi)) * std::complex(q(0, 2), q(1, 2)),
          std::sqrt(5 / (96 * pi)) * std::complex(q(0, 0) - q(1, 1), 2 * q(0, 1))};
}

RigidBody about_centre(RigidBody body) {
  const Vec3 shift = body.first_moment / body.mass;
  if (!(body.mass != 0) || !(shift.norm() <= 1e6 * body.radius))
    throw Error(Fault::bad_argument,
                fmt::format("the body weighs {}, nothing or nothing but rounding: it has no centre of mass and no free "
                            "body turns about any other point",
                            body.mass));
  body.first_moment = Vec3::Zero();
  body.quadrupole -= body.mass * (3 * shift * shift.transpose() - shift.squaredNorm() * Eigen::Matrix3d::Identity());
  if (body.trace) *body.trace -= body.mass * shift.squaredNorm();
  if (body.origin) *body.origin += shift;
  body.origin_kind = "centre of mass";
  body.radius += shift.norm();
  return body;
}

void check_weighs(const RigidBody& centred) {
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(centred.inertia()).eigenvalues()[0];
  if (centred.mass > 0 && least > 0) return;
  const bool si = centred.units.stated;
  throw Error(Fault::bad_argument,
              fmt::format("the body weighs {:.6g}{} and its least moment of inertia is {:.6g}{}: only one with both "
                          "above 0 moves as bodies do; change its density, or that of its parts",
                          centred.mass, si ? " kg" : "", least, si ? " kg m^2" : ""));
}

RigidBody with_moments(RigidBody body, Multipoles moments, int order) {
  check_weighs(body);
  body.order = order;
  if (order < 3) return body;
  for (int l = 0; l <= 2; ++l)
    for (int m = 0; m <= l; ++m) moments(l, m) = 0;
  body.higher = std::make_shared<const reference::ExteriorPotential<long double>>(moments, order);
  return body;
}

RigidBody free_body(const Body& body, int order, Monitor& monitor) {
  RigidBody centred = about_centre(rigid_body(body));
  if (order < 3) return with_moments(std::move(centred), {}, order);
  return with_moments(std::move(centred), mass_moments(mass_problems(body, order, 0), *make_cpu_backend(), monitor),
                      order);
}

RigidBody free_body(const CoefficientSet& set, const Units& units, int order) {
  const RigidBody own = rigid_body(set, units);
  RigidBody centred = about_centre(own);
  if (order < 3) return with_moments(std::move(centred), {}, order);
  if (set.lmax < order)
    throw Error(Fault::file_format,
                fmt::format("these coefficients end at degree {}, and --order {} was asked for", set.lmax, order));
  if (own.first_moment.norm() > 1e-6 * own.mass * own.radius)
    throw Error(
        Fault::file_format,
        fmt::format("these coefficients are about a point {:.3g} m off the centre of mass, about which the body "
                    "turns; degrees above 2 are those of that point: take --order 2, or the mesh",
                    own.first_moment.norm() / own.mass));
  return with_moments(std::move(centred), in_si(mass_moments(set, order), units.metre, std::pow(units.metre, 3)),
                      order);
}

RigidBody solid_body(const Body& body) {
  RigidBody solid = about_centre(rigid_body(body));
  check_weighs(solid);
  append(solid, body.surface);
  for (const Part& part : body.parts)
    if (part.density > 0) append(solid, part.surface);
  return solid;
}

PrincipalAxes principal_axes(const RigidBody& body) {
  // By the traceless tensor: of a body that is nearly a ball the inertia's differences are lost in its size.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(-body.quadrupole);
  PrincipalAxes result;
  result.quadrupole = -solver.eigenvalues();
  result.axes = solver.eigenvectors();
  orient(result.axes.col(0));
  orient(result.axes.col(1));
  result.axes.col(2) = result.axes.col(0).cross(result.axes.col(1));
  if (body.trace) result.moments = (Vec3::Constant(2 * *body.trace) - result.quadrupole) / 3;
  double noise = 1e-9 * result.quadrupole.cwiseAbs().maxCoeff();
  if (body.trace) noise = std::max(noise, 1e-14 * std::abs(*body.trace));
  result.first_two_alike = result.quadrupole[0] - result.quadrupole[1] <= noise;
  result.last_two_alike = result.quadrupole[1] - result.quadrupole[2] <= noise;
  return result;
}

} // namespace cowgpu::physics
