#include "host/requests/tides.hpp"

#include "host/error.hpp"
#include "host/physics/radiate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace cowgpu {

using namespace physics;

namespace {

constexpr int default_order = 6;

// Principal axes (least moment first) along x, y, z of the orbit frame.
LongMat3 aligned(const PrincipalAxes& principal) {
  const LongMat3 axes = principal.axes.cast<long double>();
  return axes.transpose() * (3 * LongMat3::Identity() - axes * axes.transpose()) / 2;
}

int order_of(const LoadedMass& loaded, int asked, std::vector<std::string>& notes) {
  if (asked > 0 || loaded.mesh) return asked > 0 ? asked : default_order;
  const RigidBody own = rigid_body(loaded);
  const bool off = own.first_moment.norm() > 1e-6 * own.mass * own.radius;
  const int order = off ? 2 : std::min(default_order, loaded.coefficients->lmax);
  if (order < default_order)
    notes.push_back(off ? "the coefficients are not about the centre of mass: only degree 2, which can be moved there"
                        : fmt::format("the coefficients end at degree {}", order));
  return order;
}

void add_notes(const TidesRequest& request, const LoadedMass& loaded, TidesResult& t) {
  // Farther out the sphere of no body that the coefficients describe is in question.
  if (const std::string note = unknown_radius_note(loaded); !note.empty() && request.radius < 10 * t.body.radius)
    t.subject.notes.push_back(note);
  if (request.radius < t.centre.radius)
    t.subject.notes.push_back(fmt::format(
        "an orbit of this radius runs inside the {}, whose radius is {:g} km and which is taken for a point",
        t.centre.name, t.centre.radius / 1e3));
}

// The mechanics here is Newton's.
void check_speed(double speed, const std::string& what, const char* cure, std::vector<std::string>& notes) {
  if (speed >= speed_of_light_si)
    throw Error(Fault::bad_argument, fmt::format("{} moves at {:.3g} m/s, faster than light: {}", what, speed, cure));
  if (speed >= 0.1 * speed_of_light_si)
    notes.push_back(fmt::format("{} moves at {:.2g} of the speed of light, and the formulas are for slow ones", what,
                                speed / speed_of_light_si));
}

void check_speeds(const TidesRequest& request, TidesResult& t) {
  check_speed(t.orbit.rate * request.radius, "the body on its orbit", "lower --mass or take a wider --orbit",
              t.subject.notes);
  if (request.spin && t.body.radius_known)
    check_speed(*request.spin * t.body.radius, "the rim of the spinning body", "lower --spin", t.subject.notes);
}

void add_locking(const TidesRequest& request, TidesResult& t) {
  const double spin = request.spin.value_or(0);
  if (spin > 0 && !t.isotropic) t.caught = std::abs(spin - t.orbit.rate) < capture_half_width(t.principal, t.orbit);
  if (!request.love && !request.quality) return;
  if (!request.love || !request.quality || !request.spin)
    throw Error(Fault::bad_argument, "the time to lock needs all of --love, --quality and --spin");
  t.locking_time = locking_time(t.body, t.orbit, spin, *request.love, *request.quality);
}

std::vector<AttitudeShift> shifts(const TidesResult& t) {
  std::vector<AttitudeShift> all;
  const LongMat3 start = aligned(t.principal);
  for (const int out : {1, -1})
    for (const int up : {1, -1}) {
      const LongVec3 half(out, out * up, up);
      all.push_back({out, up, shifted_equilibrium(t.body, t.orbit, LongMat3(half.asDiagonal()) * start)});
    }
  return all;
}

} // namespace

TidesResult tides(const TidesRequest& request, Monitor& monitor) {
  if (request.attitude) check_rotation(request.attitude->cast<double>(), "the attitude");
  if (request.order != 0) check_multipole_order(request.order);
  for (const auto& [value, what] : {std::pair(request.spin.value_or(1), "the spin"),
                                    std::pair(request.centre.mass(), "the mass at the centre of the orbit")})
    if (!(value > 0) || !std::isfinite(value))
      throw Error(Fault::bad_argument, fmt::format("{} is {}; it must be above 0 and finite", what, value));
  const LoadedMass loaded = load_mass(request.body, Motion::free, monitor);
  TidesResult t;
  t.subject = subject(loaded);
  t.subject.notes.insert(t.subject.notes.end(), request.notes.begin(), request.notes.end());
  require_units(loaded);
  t.centre = request.centre;
  t.body = free_body(loaded, order_of(loaded, request.order, t.subject.notes), monitor);
  t.principal = principal_axes(t.body);
  t.orbit = circular_orbit(t.centre, t.body, request.radius);
  check_speeds(request, t);
  add_notes(request, loaded, t);
  t.isotropic = is_isotropic(t.principal);
  t.stable = libration(t.principal, t.orbit, {0, 1, 2});
  t.attitude = request.attitude ? *request.attitude : aligned(t.principal);
  RigidBody quadrupole = t.body;
  quadrupole.higher.reset();
  t.torque = orbit_torque(t.body, t.orbit, t.attitude);
  t.torque_quadrupole = orbit_torque(quadrupole, t.orbit, t.attitude);
  t.largest_torque = largest_quadrupole_torque(t.principal, t.orbit);
  if (!t.isotropic) t.capture_half_width = capture_half_width(t.principal, t.orbit);
  add_locking(request, t);
  if (t.isotropic) return t;
  t.equilibria = relative_equilibria(t.principal, t.orbit);
  if (t.body.order > 2) t.shifts = shifts(t);
  return t;
}

} // namespace cowgpu
