#include "host/requests/radiate.hpp"

#include "host/bounds.hpp"
#include "host/error.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/mesh/tensors.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu {

using namespace physics;

namespace {

// The spherical formula, of multipoles that no Cartesian tensor went into.
double by_multipoles(const LoadedMass& loaded, const RigidBody& body, const Vec3& axis) {
  if (!loaded.mesh) return quadrupole_square(spherical_quadrupole(body.quadrupole), axis);
  Monitor monitor;
  const Multipoles q = mass_moments(mass_problems(*loaded.mesh, 2, 0), *make_cpu_backend(1), monitor);
  const double r2 = q.reference_radius * q.reference_radius;
  return quadrupole_square(std::array{r2 * q(2, 0), r2 * q(2, 1), r2 * q(2, 2)}, axis);
}

void check_speed(const RadiationResult& r, std::vector<std::string>& notes) {
  // Of a body whose sphere is not known some matter is at least as far from the axis as the radius of gyration.
  const bool known = r.body.radius_known;
  const double radius = known ? r.body.radius : r.moment ? std::sqrt(*r.moment / r.body.mass) : 0;
  const double speed = r.omega * radius;
  if (speed >= speed_of_light_si)
    throw Error(Fault::bad_argument,
                fmt::format("at {} rad/s a body of {} m moves at {:.3g} m/s, faster than light: lower "
                            "--omega",
                            r.omega, radius, speed));
  if (speed >= 0.1 * speed_of_light_si)
    notes.push_back(fmt::format("the body moves at {:.2g} of the speed of light, and the formula is for slow ones",
                                speed / speed_of_light_si));
  else if (!known && r.omega * r.body.radius >= 0.1 * speed_of_light_si)
    notes.push_back(fmt::format("the file does not say how large its body is; if it reaches its reference radius of "
                                "{:.6g} m, it moves at {:.2g} of the speed of light, and the formula is for slow ones; "
                                "--brillouin-radius states how large it is",
                                r.body.radius, r.omega * r.body.radius / speed_of_light_si));
}

void check_wobble(const Eigen::Matrix3d& inertia, const Vec3& axis, std::vector<std::string>& notes) {
  const Vec3 spin = inertia * axis;
  const double angle = std::atan2(spin.cross(axis).norm(), spin.dot(axis)) * 180 / std::numbers::pi;
  if (angle > 1e-6)
    notes.push_back(
        fmt::format("the axis is not a principal axis: the angular momentum is {:.3g} degrees off it, and the body "
                    "turns about it only where it is held",
                    angle));
}

void check_mass(const RigidBody& body, const Vec3& axis) {
  const char* mass_unit = body.units.stated ? " kg" : "";
  const char* moment_unit = body.units.stated ? " kg m^2" : "";
  if (!(body.mass > 0))
    throw Error(Fault::bad_argument, fmt::format("the body weighs {:.6g}{}: only one with a mass above 0 spins down; "
                                                 "change --density or the density of a --part",
                                                 body.mass, mass_unit));
  if (!body.trace) return;
  if (const double moment = axis.dot(body.inertia() * axis); !(moment > 0))
    throw Error(Fault::bad_argument,
                fmt::format("the body weighs {:.6g}{}, but its moment of inertia about the axis is {:.6g}{}: only one "
                            "with both above 0 spins down; change --density or the density of a --part",
                            body.mass, mass_unit, moment, moment_unit));
}

} // namespace

RadiationResult radiate(const RadiateRequest& request, Monitor& monitor) {
  check_direction(request.axis, "the axis");
  require_positive("the rate of the turn is", request.omega, " rad/s");
  require_not_negative("the time from the start of the turn is", request.time, " s");
  if (request.omega < slowest_turn)
    throw Error(Fault::bad_argument, fmt::format("{:.3g} rad/s is slower than a turn in 400 Gyr, {} rad/s, which is as "
                                                 "slow as this goes",
                                                 request.omega, slowest_turn));
  const LoadedMass loaded = load_mass(request.body, Motion::free, monitor);
  RadiationResult r;
  r.subject = subject(loaded);
  r.subject.notes.insert(r.subject.notes.end(), request.notes.begin(), request.notes.end());
  r.axis = request.axis;
  r.omega = request.omega;
  r.time = request.time;
  r.body = about_centre(rigid_body(loaded));
  if (loaded.mesh) {
    const ClosedSurface& surface = loaded.mesh->surface;
    r.longest_side = bounding_box(surface.vertices(), surface.faces()).longest_side();
  }
  check_mass(r.body, r.axis);
  r.square = quadrupole_square(r.body.quadrupole, r.axis);
  const double scale = r.body.quadrupole.squaredNorm(), size = r.body.trace.value_or(0);
  const double largest = std::max(scale, size * size);
  if ((size > 0 || !r.body.quadrupole.isZero(0)) && !std::isnormal(largest))
    throw Error(Fault::bad_argument,
                "the body is too small or too large for the squares of its tensors to be computed: "
                "give another unit of length, or another density");
  r.spherical_difference =
      std::abs(by_multipoles(loaded, r.body, r.axis) - r.square) / std::max(64 * scale, 1e-12 * size * size);
  if (r.square <= 1e-26 * largest) {
    r.square = 0;
    r.subject.notes.push_back(
        "turned about this axis the quadrupole stays as it is, but for rounding: it radiates nothing");
  }
  if (request.octupole) {
    if (!loaded.mesh)
      throw Error(Fault::file_format,
                  "--octupole: the current quadrupole needs the integral of density r^2 x, which no "
                  "file of multipoles holds; take the mesh");
    const Tensor3 third = third_moment(*loaded.mesh);
    r.octupole = octupole_square(third, r.axis);
    r.current_quadrupole = current_quadrupole_square(third, r.axis);
  }
  if (r.body.trace) {
    r.moment = r.axis.dot(r.body.inertia() * r.axis);
    check_wobble(r.body.inertia(), r.axis, r.subject.notes);
  } else {
    r.subject.notes.push_back("the file does not say the second moment: no energy and no time without it; the JSON of "
                              "`cowgpu expand` holds it");
  }
  if (!r.body.units.stated) {
    r.subject.notes.push_back(
        "no unit was stated: --length 2.5m (or --length-unit) and --density 1g/cm3 give watts and seconds");
    return r;
  }
  check_speed(r, r.subject.notes);
  r.power = quadrupole_power(r.square, r.omega);
  if (r.square > 0 && !std::isnormal(double(r.power)))
    throw Error(Fault::bad_argument,
                fmt::format("at {:.3g} rad/s this body radiates {:.3g} W, which doubles cannot hold: give "
                            "another --omega or --period, or another unit of length",
                            r.omega, r.power));
  if (r.moment) r.spin = spin_down(*r.moment, r.power, r.omega, r.time);
  return r;
}

} // namespace cowgpu
