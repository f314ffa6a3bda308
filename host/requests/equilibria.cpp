#include "host/requests/equilibria.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/mesh/placement.hpp"
#include "host/physics/potential.hpp"
#include "host/physics/zero_velocity.hpp"
#include "host/report/result.hpp"
#include "host/requests/body_measures.hpp"
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
  check_mass(r.body, r.mass);
  check_spin_rate(r.spin_rate);
  if (r.spin_axis) check_direction(*r.spin_axis, "the axis of --spin");
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
  BodyRequest placed = request.body;
  if (request.mass) placed.density = 1; // until the volume is known
  LoadedMass loaded = load_mass(placed, Motion::free, monitor);
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
