#include "host/requests/equilibria.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/mesh/placement.hpp"
#include "host/physics/potential.hpp"
#include "host/physics/zero_velocity.hpp"
#include "host/report/result.hpp"
#include "host/requests/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {

using namespace physics;

namespace {

[[noreturn]] void refuse(const std::string& sentence) {
  throw Error(Fault::bad_argument, sentence);
}

void check_request(const EquilibriaRequest& r) {
  if (is_coefficient_file(r.body.mesh))
    throw Error(
        Fault::file_format,
        fmt::format("{} holds multipoles, whose series is not the field near the body and inside it: take the mesh",
                    r.body.mesh));
  if (r.body.charge) refuse("equilibria are those of gravity: leave --charge out");
  if (r.mass && r.body.density) refuse("--mass and --density both say how heavy the body is; leave one out");
  if (r.mass && !r.body.parts.empty())
    refuse("--mass says the mass of a body of one density, and --part adds others: give --density in its place");
  if (r.mass && !(r.mass->value > 0)) refuse(fmt::format("--mass {}: it must be above 0", r.mass->value));
  if (!(r.spin_rate.value > 0) || !std::isfinite(r.spin_rate.value))
    refuse(fmt::format("the spin {} must be above 0 and finite", r.spin_rate.value));
  if (r.spin_axis) check_direction(*r.spin_axis, "the axis of --spin");
}

// A number of a body with units has one, and of a body without has none.
void check_unit(const char* option, const Measure& measure, bool stated, const char* example) {
  if (measure.has_unit && !stated)
    refuse(
        fmt::format("{}: {} {} needs the mesh's unit of length: add --length-unit or --length, or give a bare number "
                    "in the mesh's units with G = 1",
                    option, measure.value, measure.unit));
  if (!measure.has_unit && stated)
    refuse(fmt::format("{} {}: it needs a unit, as in {}", option, measure.value, example));
}

void weigh(const Measure& mass, Body& body) {
  check_unit("--mass", mass, body.placement.units.stated, "6.69e15kg");
  const double density = mass.value / body.volume;
  if (!(density >= 1e-50) || !(density <= 1e50))
    refuse(
        fmt::format("--mass {}: of a volume of {:.6g} that is a density of {:.3g}, out of the range from 1e-50 to 1e50",
                    mass.value, body.volume, density));
  body.density = density;
}

EquilibriaResult::ZeroVelocity zero_velocity(const ZeroVelocityRequest& r, const Body& body, const EquilibriaResult& s,
                                             const Backend& backend, Monitor& monitor) {
  const auto& points = s.equilibria.points;
  ZeroVelocityProblem problem;
  problem.constant = s.constant;
  problem.spin = s.spin;
  problem.cells = r.cells;
  if (!r.jacobi && (r.equilibrium < 1 || std::size_t(r.equilibrium) > points.size()))
    refuse(fmt::format("the zero-velocity surface of equilibrium {}: {} were found", r.equilibrium, points.size()));
  problem.jacobi = r.jacobi ? *r.jacobi : points[std::size_t(r.equilibrium - 1)].jacobi;
  problem.extent = body.brillouin_radius;
  for (const Equilibrium& e : points) problem.extent = std::max(problem.extent, 1.5 * (e.at - s.centre_of_mass).norm());
  if (r.extent) {
    if (r.extent->has_unit) check_unit("--extent", *r.extent, s.si, "40km");
    problem.extent = r.extent->value;
  }
  EquilibriaResult::ZeroVelocity found{problem.jacobi, problem.extent, 2 * problem.extent / problem.cells, {}};
  found.surface = zero_velocity_surface(body, problem, backend, monitor);
  found.surface.name = fmt::format("zero-velocity surface of {}", body.surface.mesh().name);
  return found;
}

} // namespace

EquilibriaResult equilibria(const EquilibriaRequest& request, Backend& backend, Monitor& monitor) {
  check_request(request);
  BodyRequest asked = request.body;
  if (request.mass) asked.density = 1; // until the volume is known
  LoadedMass loaded = load_mass(asked, Motion::free, monitor);
  Body& body = *loaded.mesh;
  if (request.mass) weigh(*request.mass, body);
  loaded.notes.insert(loaded.notes.end(), request.notes.begin(), request.notes.end());
  EquilibriaResult s;
  s.si = body.placement.units.stated;
  check_unit("--omega or --period", request.spin_rate, s.si, "--period 5.27h or --omega 3e-4rad/s");
  s.axis_found = !request.spin_axis;
  s.spin = {request.spin_rate.value, request.spin_axis ? *request.spin_axis : largest_principal_axis(body),
            body.origin};
  if (s.si) s.constant = gravitational_constant_si;
  s.subject = subject(loaded);
  s.mass = body.mass();
  s.density = body.density;
  s.centre_of_mass = body.centre_of_mass;
  s.synchronous = synchronous_radius(body, s.constant, s.spin);
  EquilibriaProblem problem;
  problem.constant = s.constant;
  problem.spin = s.spin;
  problem.smallest = request.smallest;
  problem.most_places = request.cells;
  check_memory(equilibria_memory(body, problem, backend), backend, "allow fewer --cells");
  s.equilibria = equilibria(body, problem, backend, monitor);
  if (request.surface) s.zero_velocity = zero_velocity(*request.surface, body, s, backend, monitor);
  s.device = device_line(backend.facts());
  return s;
}

} // namespace cowgpu
