#include "host/requests/tip.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/io/surface_file.hpp"
#include "host/requests/expand_surfaces.hpp"
#include "host/requests/limits.hpp"
#include "host/requests/memory.hpp"
#include "host/requests/surface_source.hpp"
#include "host/spectrum/expand_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace cowgpu {

using namespace physics;

namespace {

constexpr double least_gravity = 1e-6, largest_gravity = 1e13; // m/s^2
constexpr double least_weight = 1e-30, largest_weight = 1e40;  // N

// Contact points are a matter of triangles: finer ones than a picture needs.
int tip_resolution(int order) {
  return std::max(default_resolution(order), 128);
}

int resolution_of(const TipRequest& request, int order) {
  return request.resolution > 0 ? request.resolution : tip_resolution(order);
}

int largest_order(const TipRequest& request) {
  return request.orders.empty() ? 0 : *std::max_element(request.orders.begin(), request.orders.end());
}

void scale(SurfaceExpansion& expansion, double factor) {
  SphereCoefficients& a = expansion.coefficients;
  const std::size_t count = SphereCoefficients::count(a.lmax);
  for (const std::size_t field : {0, 3, 4, 5})
    for (std::size_t i = 0; i < count; ++i) a.values[field * count + i] *= factor;
  expansion.origin *= factor;
}

// What stands on the ground, and the surface that its orders are of.
struct Standing {
  Subject subject;
  RigidBody body; // with its surface
  std::string body_is;
  std::optional<SurfaceExpansion> expansion; // in the units of `body`
  std::string expansion_name;
};

void check_orders(const TipRequest& request, int lmax, Backend& backend) {
  const std::string& file = request.body.mesh;
  const int largest = largest_order(request);
  if (largest > lmax)
    throw Error(Fault::bad_argument,
                fmt::format("order {} cannot be rebuilt: {} holds degrees 0 to {}", largest, file, lmax));
  if (request.resolution > 0 && request.resolution < largest)
    throw Error(Fault::bad_argument, fmt::format("--resolution {} cannot show order {}; it must be at least the order",
                                                 request.resolution, largest));
  check_memory(rebuild_memory(largest, resolution_of(request, largest), backend), backend,
               "lower --order or --resolution");
}

TriangleSurface order_surface(const TipRequest& request, const SurfaceExpansion& expansion, int order, Backend& backend,
                              Monitor& monitor) {
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, resolution_of(request, order));
  TriangleSurface surface = reconstruct(expansion, request.fields, order, grid, backend, monitor);
  surface.name = fmt::format("order {}", order);
  return surface;
}

Standing from_coefficients(const TipRequest& request, Backend& backend, Monitor& monitor) {
  const BodyRequest& asked = request.body;
  const std::string& file = asked.mesh;
  refuse_placing(asked);
  if (request.lmax >= 0)
    throw Error(Fault::bad_argument, fmt::format("--lmax is for meshes: {} holds an expansion already", file));
  SurfaceSource source;
  if (holds_expansions(file)) {
    source = load_surface({file, request.of, request.mesh, -1}, 0, backend, monitor);
  } else {
    if (!request.mesh.empty())
      throw Error(Fault::bad_argument, fmt::format("--mesh: only the JSON of `cowgpu expand` says how its mesh was "
                                                   "placed, and {} is another file",
                                                   file));
    source = {read_surface_fields(file, request.of)};
  }
  const bool metric = source.placement.units.stated;
  if (metric && asked.length_unit)
    throw Error(Fault::bad_argument, fmt::format("--length-unit: {} is in metres already", file));
  const double density = asked.density.value_or(1), metre = asked.length_unit.value_or(1);
  if (!(density > 0))
    throw Error(Fault::bad_argument,
                fmt::format("--density {}: the body weighs nothing or less; it must be above 0", density));
  const bool stated = metric || asked.length_unit;
  const Units units{metre, stated ? density * metre * metre * metre : 1, stated};
  scale(source.expansion, metre);
  Standing standing;
  const int lmax = source.expansion.coefficients.lmax;
  standing.subject = {fmt::format("coefficients {}, surface {} to degree {}", file, source.name, lmax), "coefficients",
                      file, "", source.notes};
  std::vector<std::string>& notes = standing.subject.notes;
  if (const std::string note = density_note(asked, units); !note.empty()) notes.push_back(note);
  standing.expansion = std::move(source.expansion);
  standing.expansion_name = source.name;
  check_orders(request, lmax, backend);
  if (source.body) {
    RawMesh mesh = source.body->surface.mesh();
    for (Vec3& v : mesh.vertices) v *= metre;
    standing.body = solid_body(make_body(ClosedSurface::from(std::move(mesh)), {}, density));
    standing.body_is = "the mesh " + request.mesh;
  } else {
    check_memory(rebuild_memory(lmax, resolution_of(request, lmax), backend), backend,
                 "lower --resolution, or name the body with --mesh");
    const TriangleSurface surface = order_surface(request, *standing.expansion, lmax, backend, monitor);
    std::string note;
    standing.body = smooth_body(surface, density * std::abs(volume(surface.vertices, surface.faces)), note);
    standing.body_is = fmt::format("order {}, the last of the file: --mesh names the true body", lmax);
  }
  standing.body.units = units;
  notes.insert(notes.end(), request.notes.begin(), request.notes.end());
  return standing;
}

ExpansionChoice expansion_of(const TipRequest& request) {
  const auto map = request.of.empty() ? MapMethod::stretch : map_method_named(request.of);
  if (!map)
    throw Error(Fault::bad_argument,
                fmt::format("--of {}: a body is rebuilt over one map: harmonic, stretch, smooth or flow", request.of));
  ExpansionChoice choice;
  choice.maps = {*map};
  const int largest = largest_order(request);
  choice.lmax = request.lmax >= 0 ? request.lmax : std::max(largest, default_lmax);
  if (largest > choice.lmax)
    throw Error(Fault::bad_argument, fmt::format("order {} is beyond --lmax {}; raise --lmax", largest, choice.lmax));
  return choice;
}

Standing from_mesh(const TipRequest& request, Backend& backend, Monitor& monitor) {
  const std::string& file = request.body.mesh;
  if (!request.mesh.empty())
    throw Error(Fault::bad_argument, fmt::format("--mesh is for coefficients: {} is a mesh", file));
  if (request.orders.empty() && (!request.of.empty() || request.lmax >= 0 || request.resolution > 0))
    throw Error(Fault::bad_argument, "--of, --lmax and --resolution are about orders of the expansion; add --order");
  const ExpansionChoice choice = expansion_of(request);
  const LoadedMass loaded = load_mass(request.body, Motion::held, monitor);
  const Body& body = *loaded.mesh;
  Standing standing;
  standing.subject = subject(loaded);
  standing.body = solid_body(body);
  standing.body_is = "the mesh";
  std::vector<std::string>& notes = standing.subject.notes;
  if (std::any_of(body.parts.begin(), body.parts.end(), [](const Part& part) { return part.density < 0; }))
    notes.push_back("parts of negative density are holes: the body neither stands on them nor is pushed at them");
  notes.insert(notes.end(), request.notes.begin(), request.notes.end());
  if (request.orders.empty()) return standing;
  check_memory(surfaces_memory(choice, body.surface.vertices(), body.surface.faces(), backend), backend,
               "lower --lmax");
  std::vector<SurfaceResult> results = expand_surfaces(choice, false, body, backend, monitor);
  check_surfaces(results);
  SurfaceResult& result = results.front();
  standing.expansion_name = name(result.of);
  standing.expansion = std::move(result.expansion);
  for (const std::string& sentence : result.quality.sentences) notes.push_back("map: " + sentence);
  if (!body.parts.empty()) notes.push_back("orders are of the outer surface, uniform, with the mass of all parts");
  check_orders(request, standing.expansion->coefficients.lmax, backend);
  return standing;
}

void check_gravity(double gravity) {
  if (!(gravity >= least_gravity && gravity <= largest_gravity))
    throw Error(
        Fault::bad_argument,
        fmt::format("--gravity {}: it must be from {:g} m/s^2 to {:g} m/s^2, as it is from the smallest asteroids to "
                    "neutron stars",
                    gravity, least_gravity, largest_gravity));
}

void check_weight(const RigidBody& body, double gravity) {
  const double weight = body.mass * gravity;
  if (body.units.stated && !(weight >= least_weight && weight <= largest_weight))
    throw Error(Fault::bad_argument,
                fmt::format("the body weighs {:.3g} N: a push can be followed from {:g} N to {:g} N; look at --length, "
                            "--length-unit and --density",
                            weight, least_weight, largest_weight));
}

StandOptions stand_options(const TipRequest& request, const Units& units) {
  StandOptions how;
  how.as_modelled = request.as_modelled;
  if (!request.contact_tolerance) return how;
  const Measure& tolerance = *request.contact_tolerance;
  if (!(tolerance.value >= 0))
    throw Error(Fault::bad_argument, fmt::format("--contact-tolerance {}: it must not be below 0", tolerance.value));
  if (tolerance.has_unit && !units.stated)
    throw Error(Fault::bad_argument, fmt::format("--contact-tolerance {} m: a length with a unit needs the mesh's: add "
                                                 "--length-unit or --length",
                                                 tolerance.value));
  how.contact_tolerance = tolerance.value * (tolerance.has_unit ? 1 : units.metre);
  return how;
}

TippingForces tipping_forces(const TipRequest& request, const Stance& stance) {
  TippingForces forces;
  forces.left = tipping(stance, Side::left);
  forces.right = tipping(stance, Side::right);
  forces.side = request.side ? *request.side : weaker_side(forces.left, forces.right);
  forces.mass = stance.body.mass;
  forces.gravity = request.gravity;
  forces.settle_angle = stance.attitude.angle;
  forces.held = stance.held;
  return forces;
}

TippedOrder tip_order(const TipRequest& request, const Standing& standing, StandOptions how, int order,
                      Backend& backend, Monitor& monitor) {
  TippedOrder tipped{order, {}, {}};
  if (order == 0) how.as_modelled = true; // a ball stands in any attitude, but on facets of its triangulation
  try {
    RigidBody body = smooth_body(order_surface(request, *standing.expansion, order, backend, monitor),
                                 standing.body.mass, tipped.note);
    tipped.forces = tipping_forces(request, stand(std::move(body), how, monitor));
  } catch (const Error& error) {
    if (error.fault() != Fault::cannot_stand && error.fault() != Fault::mesh_no_volume &&
        error.fault() != Fault::mesh_not_finite)
      throw;
    const std::string reason = error.what();
    tipped.note = reason.substr(0, reason.find(';')); // without the advice
  }
  return tipped;
}

PushOutcome push_outcome(const PushRequest& asked, const Rocker& rocker, const Monitor& monitor) {
  PushOutcome outcome{asked, rocker, rocker.least_duration(asked.punch, monitor), {}, {}, {}};
  if (asked.punch_duration) outcome.punch_force_needed = rocker.least_force(*asked.punch_duration, monitor);
  if (asked.profile) outcome.pushed = push(rocker, *asked.profile, monitor);
  const double threshold = rocker.threshold();
  std::vector<BoundaryPoint>& points = outcome.boundary;
  points = {{asked.sustained, asked.sustained_name + " sustained"},
            {asked.punch, asked.punch_name + " punch"},
            {threshold, "threshold"}};
  for (const double factor : {1.001, 1.01, 1.03, 1.1, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0, 50.0, 100.0})
    points.push_back({factor * threshold, ""});
  std::stable_sort(points.begin(), points.end(),
                   [](const BoundaryPoint& a, const BoundaryPoint& b) { return a.force < b.force; });
  for (BoundaryPoint& point : points) {
    point.least_duration = rocker.least_duration(point.force, monitor);
    const bool tips = std::isfinite(point.least_duration);
    const Profile pulse = square_pulse(point.force, tips ? point.least_duration * (1 + 1e-9) : 1);
    point.friction_needed = push(rocker, pulse, monitor).friction_needed;
  }
  return outcome;
}

void check_push(const PushRequest& push) {
  require_range("the force that lasts, in N, is", push.sustained, least_force, largest_force);
  require_range("the force of the punch, in N, is", push.punch, least_force, largest_force);
  if (push.punch_duration)
    require_range("the duration of the punch, in s, is", *push.punch_duration, shortest_push, longest_push);
  if (!push.profile) return;
  for (const double force : push.profile->force)
    require_range("the force of the push, in N, is", force, 0.0, largest_force);
  for (const double time : push.profile->time) require_range("the time of the push, in s, is", time, 0.0, longest_push);
}

} // namespace

bool rebuilds_surfaces(const TipRequest& request) {
  return !request.orders.empty() || is_coefficient_file(request.body.mesh);
}

TipResult tip(const TipRequest& request, Backend& backend, Monitor& monitor) {
  check_push(request.push);
  require_range("the resolution is", request.resolution, 0, largest_grid_degree);
  require_range("the degree of the expansion is", std::max(request.lmax, 0), 0, largest_surface_degree);
  require_not_negative("the coefficient of friction is", request.friction.value_or(0));
  require_member("the fields are", request.fields, SurfaceFields::f);
  if (request.side) require_member("the side is", *request.side, Side::right);
  check_gravity(request.gravity);
  Standing standing = is_coefficient_file(request.body.mesh) ? from_coefficients(request, backend, monitor)
                                                             : from_mesh(request, backend, monitor);
  RigidBody& body = standing.body;
  const bool si = body.units.stated;
  if (!si && (request.push.profile || request.push.punch_duration || request.boundary))
    throw Error(Fault::bad_argument,
                "--push, --punch-duration and --plot are about newtons and seconds: add --length, how long "
                "the body is, or --length-unit, and its --density");
  check_weight(body, request.gravity);
  const StandOptions how = stand_options(request, body.units);
  body.smooth = body.smooth || request.smooth;
  TipResult result;
  result.stance = stand(body, how, monitor);
  result.forces = tipping_forces(request, result.stance);
  result.as_modelled = request.as_modelled;
  result.side_given = request.side.has_value();
  result.friction = request.friction;
  const Rocker pushed = rocker(body.mass, result.forces.chosen(), request.gravity, request.push.turns_with_body);
  if (si && pushed.balance > 0) result.push = push_outcome(request.push, pushed, monitor);
  if (request.boundary && !result.push)
    throw Error(Fault::bad_argument, "--plot: any push tips this body, so there is no boundary to draw");
  for (std::size_t i = 0; i < request.orders.size(); ++i) {
    check_stop(monitor);
    monitor.progress("orders stood up", double(i) / double(request.orders.size()));
    result.orders.push_back(tip_order(request, standing, how, request.orders[i], backend, monitor));
  }
  result.subject = std::move(standing.subject);
  result.body = std::move(standing.body);
  result.body_is = std::move(standing.body_is);
  if (standing.expansion) result.expansion = standing.expansion_name;
  return result;
}

} // namespace cowgpu
