#include "host/requests/surface_gravity.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/mesh/geometry.hpp"
#include "host/physics/body_field.hpp"
#include "host/report/result.hpp"
#include "host/requests/body_measures.hpp"
#include "host/requests/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cowgpu {

using namespace physics;

namespace {

constexpr std::uint64_t many_places = 20000; // from which on a second or more is lost
constexpr double largest_height = 1e6;       // in Brillouin radii: beyond it slopes and elevations are rounding

[[noreturn]] void refuse(const std::string& sentence) {
  throw Error(Fault::bad_argument, sentence);
}

void check_request(const SurfaceGravityRequest& r) {
  if (is_coefficient_file(r.body.mesh))
    throw Error(
        Fault::file_format,
        fmt::format("{} holds multipoles, whose series is not the field on the surface: take the mesh", r.body.mesh));
  if (r.body.charge) refuse("gravity on a surface is that of masses: leave --charge out");
  check_mass(r.body, r.mass);
  if (r.place == ValuePlace::points && r.points.empty()) refuse("there is no point to ask for gravity at");
  if (r.place == ValuePlace::points && r.height)
    refuse("--height is above faces or vertices, whose normals it follows; points stand where they are");
  if (r.spin_axis && !r.spin_rate)
    refuse("--spin says what the body turns about, and not how fast: add --period or --omega");
  if (r.spin_rate) check_spin_rate(*r.spin_rate);
  if (r.spin_axis) check_direction(*r.spin_axis, "the axis of --spin");
  if (r.tolerance != 0 && !(r.tolerance >= least_polyhedron_tolerance && r.tolerance <= largest_polyhedron_tolerance))
    refuse(
        fmt::format("--tolerance {}: it is from {} to {}, a part of G M/R^2, or 0, which sums all faces at all places",
                    r.tolerance, least_polyhedron_tolerance, largest_polyhedron_tolerance));
  if (r.guarantee && r.tolerance == 0)
    refuse("--guarantee is about what a tolerance leaves out, and --tolerance 0 leaves nothing out: leave one of them "
           "out");
}

std::optional<Spin> spin_of(const SurfaceGravityRequest& r, const Body& body) {
  if (!r.spin_rate) return std::nullopt;
  check_unit("--omega or --period", *r.spin_rate, body.placement.units.stated, "--period 5.27h or --omega 3e-4rad/s");
  return Spin{r.spin_rate->value, r.spin_axis ? *r.spin_axis : largest_principal_axis(body), body.origin};
}

SurfacePlaces places_of(SurfaceGravityPlan& plan) {
  const ClosedSurface& surface = plan.body().surface;
  if (plan.request.place == ValuePlace::points) return point_places(std::move(plan.request.points));
  return plan.request.place == ValuePlace::faces ? face_places(surface, plan.height)
                                                 : vertex_places(surface, plan.height);
}

void check_reach(const std::vector<Vec3>& at, const Body& body, const std::string& name) {
  for (std::size_t i = 0; i < at.size(); ++i)
    if (!std::isfinite((at[i] - body.origin).stableNorm()) ||
        !((at[i] - body.origin).stableNorm() < 1e150 * body.brillouin_radius))
      throw Error(
          Fault::file_format,
          fmt::format("{}: place {} of {} is farther than 1e150 radii of the body, beyond what doubles hold of its "
                      "field",
                      name, i + 1, at.size()));
}

std::string places_text(const SurfaceGravityPlan& plan) {
  const char* above = plan.height != 0 ? ", along their normals" : "";
  if (plan.request.place == ValuePlace::faces) return fmt::format("centroids of {} faces{}", plan.places, above);
  if (plan.request.place == ValuePlace::vertices) return fmt::format("{} vertices{}", plan.places, above);
  return fmt::format("{} points of {}", plan.places, plan.request.points_name);
}

BodyFieldProblem field_problem(const SurfaceGravityRequest& r) {
  return {Derivatives::first, FieldSum::device, r.threads, r.tolerance, r.guarantee};
}

void measure(const Body& body, SurfaceGravityResult& s) {
  s.density = body.density;
  s.mass = body.mass();
  s.volume = body.volume;
  s.area = body.area;
  const Box box = bounding_box(body.surface);
  s.size = box.max - box.min;
  s.centre_of_mass = body.centre_of_mass;
  s.radius = std::cbrt(3 * body.volume / (4 * std::numbers::pi));
  s.gravity_scale = s.constant * gravity_scale(body);
}

// Where the values come from, for files.
std::vector<std::pair<std::string, std::string>> facts_of(const SurfaceGravityResult& s, const RawMesh& mesh) {
  const auto with = [&](double value, const char* unit) {
    return fmt::format("{}{}{}", value, s.si ? " " : "", s.si ? unit : "");
  };
  std::vector<std::pair<std::string, std::string>> facts;
  if (!mesh.sha256.empty()) facts.emplace_back("mesh_sha256", mesh.sha256);
  facts.emplace_back("places", s.places);
  facts.emplace_back("gravitational_constant", with(s.constant, "m^3/(kg s^2)"));
  facts.emplace_back("density", with(s.density, "kg/m^3"));
  facts.emplace_back("mass", with(s.mass, "kg"));
  facts.emplace_back("volume", with(s.volume, "m^3"));
  if (s.spin) {
    const Vec3 &axis = s.spin->axis, &through = s.spin->through;
    facts.emplace_back("spin_rate", with(s.spin->rate, "rad/s"));
    facts.emplace_back("spin_axis", fmt::format("{},{},{}", axis.x(), axis.y(), axis.z()));
    facts.emplace_back("spin_through", fmt::format("{},{},{}", through.x(), through.y(), through.z()));
  }
  facts.emplace_back("tolerance", fmt::format("{} of G M/R^2{}", s.tolerance, s.guarantee ? ", proven" : ""));
  return facts;
}

} // namespace

MemoryNeed SurfaceGravityPlan::memory(const Backend& backend) const {
  MemoryNeed need = BodyField(body(), field_problem(request), backend).memory(places);
  // Places, normals and areas, gravity as vectors beside the columns, the mesh once more in the result.
  need.host +=
      places * (7 * sizeof(double) + 2 * sizeof(Vec3) + 8 * surface_gravity_numbers(request.place, request.guarantee));
  need.host +=
      body().surface.vertices().size() * sizeof(Vec3) + body().surface.faces().size() * sizeof(Face) + extra_bytes;
  return need;
}

SurfaceGravityPlan plan_surface_gravity(SurfaceGravityRequest request, Monitor& monitor) {
  check_request(request);
  SurfaceGravityPlan plan;
  if (request.mass) request.body.density = 1; // until the volume is known
  plan.loaded = load_mass(request.body, Motion::held, monitor);
  if (request.mass) request.body.density.reset();
  Body& body = *plan.loaded.mesh;
  if (request.mass) weigh(*request.mass, body);
  if (request.height) {
    if (!std::isfinite(request.height->value))
      refuse(fmt::format("--height {}: it must be finite", request.height->value));
    if (request.height->has_unit) check_unit("--height", *request.height, body.placement.units.stated, "10m");
    if (request.height->value < 0)
      refuse("--height is below 0, inside the body: it is above the surface; places inside are points, --at FILE");
    if (request.height->value > largest_height * body.brillouin_radius)
      refuse(fmt::format("--height: it is {:.3g} radii of the body, where nothing is left of its surface; up to {} are "
                         "taken",
                         request.height->value / body.brillouin_radius, largest_height));
    plan.height = request.height->value;
  }
  plan.spin = spin_of(request, body);
  plan.places = request.place == ValuePlace::faces      ? body.surface.faces().size()
                : request.place == ValuePlace::vertices ? body.surface.vertices().size()
                                                        : request.points.size();
  plan.loaded.notes.insert(plan.loaded.notes.end(), request.notes.begin(), request.notes.end());
  plan.request = std::move(request);
  return plan;
}

SurfaceGravityResult surface_gravity(SurfaceGravityPlan plan, Backend& backend, Monitor& monitor) {
  check_memory(plan.memory(backend), backend, "take a coarser mesh, or fewer points");
  if (backend.facts().type == "software" && plan.places > many_places)
    plan.loaded.notes.push_back("a software device sums polyhedra several times slower than --device cpu");
  SurfaceGravityResult s;
  s.subject = subject(plan.loaded);
  const Body& body = plan.body();
  s.si = body.placement.units.stated;
  FieldLaw law;
  if (s.si) law.constant = gravitational_constant_si;
  s.constant = law.constant;
  measure(body, s);
  s.spin = plan.spin;
  s.height = plan.height;
  s.tolerance = plan.request.tolerance;
  s.guarantee = plan.request.guarantee;
  s.places = places_text(plan);
  SurfacePlaces places = places_of(plan);
  check_reach(places.at, body, plan.request.place == ValuePlace::points ? plan.request.points_name : "--height");
  BodyFieldValues field = BodyField(body, field_problem(plan.request), backend).at(places.at, monitor, &s.run);
  s.potential_error = s.constant * field.value_error;
  s.gravity_error = s.constant * field.gradient_error;
  s.far_points = std::uint64_t(std::count(field.by_series.begin(), field.by_series.end(), 1));
  for (double& bound : field.bound) bound *= s.constant;
  SurfaceGravity gravity =
      physics::surface_gravity(places, field.field, law, plan.spin.value_or(Spin{}), body.centre_of_mass);
  field.field = {};
  s.mean_geopotential = gravity.mean_geopotential;
  s.values.title = body.surface.mesh().name;
  s.values.place = places.place;
  if (places.place == ValuePlace::points) {
    s.values.vertices = places.at;
  } else {
    s.values.vertices = body.surface.vertices();
    s.values.faces = body.surface.faces();
  }
  s.values.places = std::move(places.at);
  s.areas = std::move(places.areas);
  take_columns(std::move(gravity), std::move(field.bound), s);
  if (plan.height != 0)
    s.values.notes.push_back(
        fmt::format("places are {} {} along the outward normals", plan.height, s.si ? "m" : "lengths of the mesh"));
  s.values.facts = facts_of(s, body.surface.mesh());
  s.device = device_line(backend.facts());
  return s;
}

} // namespace cowgpu
