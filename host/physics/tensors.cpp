#include "host/physics/tensors.hpp"

#include "host/error.hpp"
#include "host/mesh/tensors.hpp"
#include "host/spectrum/convert.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace cowgpu::physics {
namespace {

constexpr double pi = std::numbers::pi;

double known_trace(const MassTensors& tensors) {
  if (tensors.trace) return *tensors.trace;
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

} // namespace

Eigen::Matrix3d MassTensors::second_moment() const {
  return (quadrupole + known_trace(*this) * Eigen::Matrix3d::Identity()) / 3;
}

Eigen::Matrix3d MassTensors::inertia() const {
  return (2 * known_trace(*this) * Eigen::Matrix3d::Identity() - quadrupole) / 3;
}

MassTensors mass_tensors(const Body& body) {
  const Tensors own = tensors(body);
  MassTensors result;
  result.mass = body.mass();
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
  if (body.placement.metric) {
    result.length_unit = "m";
    result.mass_unit = "kg";
  }
  return result;
}

void check_mass_multipoles(const CoefficientSet& set) {
  if (set.kind == CoefficientKind::field || set.fields != 1)
    throw Error(
        Fault::file_format,
        "these are coefficients of a surface or of another field, and this asks for those of a mass: multipoles "
        "or a potential, as `cowgpu expand --of mass` and `cowgpu convert --kind multipoles` write them");
}

MassTensors mass_tensors(const CoefficientSet& set) {
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
  MassTensors result;
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
  if (!set.length_unit.empty()) result.length_unit = set.length_unit;
  if (!set.mass_unit.empty()) result.mass_unit = set.mass_unit;
  return result;
}

std::array<std::complex<double>, 3> spherical_quadrupole(const Eigen::Matrix3d& q) {
  return {std::sqrt(5 / (16 * pi)) * q(2, 2), -std::sqrt(5 / (24 * pi)) * std::complex(q(0, 2), q(1, 2)),
          std::sqrt(5 / (96 * pi)) * std::complex(q(0, 0) - q(1, 1), 2 * q(0, 1))};
}

MassTensors about_centre(const MassTensors& tensors) {
  const Vec3 shift = tensors.first_moment / tensors.mass;
  if (!(tensors.mass != 0) || !(shift.norm() <= 1e6 * tensors.radius))
    throw Error(Fault::bad_argument,
                fmt::format("the body weighs {}, nothing or nothing but rounding: it has no centre of mass and no free "
                            "body turns about any other point",
                            tensors.mass));
  MassTensors result = tensors;
  result.first_moment = Vec3::Zero();
  result.quadrupole -=
      tensors.mass * (3 * shift * shift.transpose() - shift.squaredNorm() * Eigen::Matrix3d::Identity());
  if (tensors.trace) result.trace = *tensors.trace - tensors.mass * shift.squaredNorm();
  if (tensors.origin) result.origin = *tensors.origin + shift;
  result.origin_kind = "centre of mass";
  result.radius += shift.norm();
  return result;
}

void check_weighs(const MassTensors& centred) {
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(centred.inertia()).eigenvalues()[0];
  if (centred.mass > 0 && least > 0) return;
  const bool metric = centred.metric();
  throw Error(Fault::bad_argument,
              fmt::format("the body weighs {:.6g}{} and its least moment of inertia is {:.6g}{}: only one with both "
                          "above 0 moves as bodies do; change its density, or that of its parts",
                          centred.mass, metric ? " kg" : "", least, metric ? " kg m^2" : ""));
}

MassTensors in_si(const MassTensors& tensors, double metres, double kilograms) {
  MassTensors result = tensors;
  result.mass *= kilograms;
  result.first_moment *= kilograms * metres;
  result.quadrupole *= kilograms * metres * metres;
  if (result.trace) *result.trace *= kilograms * metres * metres;
  if (result.origin) *result.origin *= metres;
  result.radius *= metres;
  result.length_unit = "m";
  result.mass_unit = "kg";
  return result;
}

PrincipalAxes principal_axes(const MassTensors& tensors) {
  // By the traceless tensor: of a body that is nearly a ball the inertia's differences are lost in its size.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(-tensors.quadrupole);
  PrincipalAxes result;
  result.quadrupole = -solver.eigenvalues();
  result.axes = solver.eigenvectors();
  orient(result.axes.col(0));
  orient(result.axes.col(1));
  result.axes.col(2) = result.axes.col(0).cross(result.axes.col(1));
  if (tensors.trace) result.moments = (Vec3::Constant(2 * *tensors.trace) - result.quadrupole) / 3;
  double noise = 1e-9 * result.quadrupole.cwiseAbs().maxCoeff();
  if (tensors.trace) noise = std::max(noise, 1e-14 * std::abs(*tensors.trace));
  result.first_two_alike = result.quadrupole[0] - result.quadrupole[1] <= noise;
  result.last_two_alike = result.quadrupole[1] - result.quadrupole[2] <= noise;
  return result;
}

} // namespace cowgpu::physics
