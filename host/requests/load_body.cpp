#include "host/requests/load_body.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/mesh_source.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/mesh/winding_notes.hpp"
#include "host/physics/potential.hpp"
#include "host/report/result.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace cowgpu {
namespace {

double metres_per_unit(double length, const RawMesh& mesh) {
  const double longest = bounding_box(mesh.vertices, mesh.faces).longest_side();
  if (!(longest > 0) || !std::isfinite(longest))
    throw Error(Fault::bad_argument, fmt::format("--length {} m: {} has no length", length, mesh.name));
  return length / longest;
}

void check_lengths(const BodyRequest& request) {
  if (request.length && request.length_unit)
    throw Error(Fault::bad_argument, "--length and --length-unit both say how large the body is; leave one out");
  for (const std::optional<double>& length : {request.length, request.length_unit})
    if (length && !(*length > 0))
      throw Error(Fault::bad_argument,
                  fmt::format("{} {} m: it must be above 0", request.length ? "--length" : "--length-unit", *length));
}

Part load_part(const PartRequest& part, const Placement& placement, Monitor& monitor) {
  try {
    RawMesh mesh = load_mended(part.mesh, {}, monitor);
    place(mesh, placement);
    return Part(ClosedSurface::from(std::move(mesh)), part.density);
  } catch (const Error& error) {
    throw Error(error.fault(), fmt::format("--part {}={}: {}", part.mesh, part.density, error.what()));
  }
}

// A file's body with the density that is stated instead of its own.
void restate_density(const BodyRequest& request, CoefficientSet& set) {
  if (set.in_si())
    throw Error(Fault::bad_argument,
                fmt::format("--density: {} is in kilograms already, and its density stands", request.mesh));
  const double density = *request.density, factor = density / set.density.value_or(1);
  if (set.kind == CoefficientKind::multipoles) {
    for (double& value : set.first) value *= factor;
    for (double& value : set.second) value *= factor;
  }
  set.density = density;
  for (std::optional<double>* of_mass : {&set.mass, &set.second_moment, &set.gm})
    if (*of_mass) **of_mass *= factor;
}

// What is stated of the sphere that holds a file's body.
void state_radius(const BodyRequest& request, CoefficientSet& set) {
  const Measure& radius = *request.brillouin_radius;
  const std::string option = fmt::format("--brillouin-radius {}{}", radius.value, radius.has_unit ? " m" : "");
  const bool metres = set.in_metres();
  if (radius.has_unit && !metres && !request.units_stated())
    throw Error(Fault::bad_argument, option +
                                         ": a length with a unit needs that of the file: add --length-unit, or give "
                                         "a bare number in the file's unit");
  if (!radius.has_unit && request.units_stated())
    throw Error(
        Fault::bad_argument,
        fmt::format("{0}: with --length-unit it needs a unit of its own, since {1} of the file's unit and {1} m "
                    "differ: such as {1}km or {1}m",
                    option, radius.value));
  if (!(radius.value > 0)) throw Error(Fault::bad_argument, option + ": it must be above 0");
  const double value = metres ? radius.value : radius.value / request.length_unit.value_or(1);
  if (set.brillouin_radius && std::abs(value - *set.brillouin_radius) > 1e-9 * value)
    throw Error(Fault::bad_argument, fmt::format("{}: {} says that it is {}, in its unit of length", option,
                                                 request.mesh, *set.brillouin_radius));
  if (!set.brillouin_radius) set.brillouin_radius = value;
}

// Of a file whose format says no units the stated one is in its numbers already.
Units units_of(const BodyRequest& request, const CoefficientSet& set) {
  const bool beside = request.units_stated() && set.units_stated;
  if (set.in_si() && request.charge)
    throw Error(
        Fault::bad_argument,
        fmt::format("--charge: {} holds a mass in kilograms; expand the body without units, and state them here "
                    "with --length-unit and --density",
                    request.mesh));
  if (set.in_si() && beside)
    throw Error(Fault::bad_argument, fmt::format("--length-unit: {} is in metres and kilograms already", request.mesh));
  if (set.in_si()) return {1, 1, true};
  if (!beside) return {};
  const double metre = *request.length_unit;
  return {metre, set.density.value_or(1) * std::pow(metre, 3), true};
}

LoadedMass load_coefficients(const BodyRequest& request) {
  check_lengths(request);
  refuse_placing(request);
  LoadedMass loaded;
  CoefficientSet set = read_coefficient_set(request.mesh, "", request.length_unit);
  physics::check_mass_multipoles(set);
  loaded.notes = request.notes;
  loaded.notes.insert(loaded.notes.end(), set.notes.begin(), set.notes.end());
  const bool beside = request.units_stated() && set.units_stated;
  if (request.density) restate_density(request, set);
  if (request.brillouin_radius) state_radius(request, set);
  loaded.units = units_of(request, set);
  if (beside && !request.density && !request.charge)
    loaded.notes.push_back(
        fmt::format("the density was not given: that of the file, {:.6g}, is taken as kg/m3", set.density.value_or(1)));
  loaded.coefficients = std::move(set);
  return loaded;
}

// Its origin is its centre of mass, whatever was asked for.
Body load_free(const BodyRequest& request, std::vector<std::string>& notes, Monitor& monitor) {
  BodyRequest anywhere = request;
  anywhere.origin = {"mesh", Vec3::Zero()}; // without a mass there is no other
  Body body = load_body(anywhere, notes, monitor);
  if (!body.centre_of_mass.allFinite())
    throw Error(
        Fault::bad_argument,
        fmt::format("{} and its parts weigh {:.3g} together, nothing or nothing but rounding: a free body turns "
                    "about its centre of mass, and this has none; change --density or the density of a --part",
                    request.mesh, body.mass()));
  const Placement placement = body.placement;
  body = make_body(std::move(body.surface), {}, body.density, std::move(body.parts));
  body.placement = placement;
  if (request.origin.point) notes.push_back("--origin changes nothing: a free body turns about its centre of mass");
  return body;
}

} // namespace

void refuse_placing(const BodyRequest& request) {
  for (const auto& [given, option] :
       {std::pair(request.origin.point.has_value(), "--origin"), std::pair(request.length.has_value(), "--length"),
        std::pair(!request.rotation.isIdentity(0), "--axes or --rotate"), std::pair(!request.parts.empty(), "--part")})
    if (given)
      throw Error(Fault::bad_argument, fmt::format("{} places a mesh, and {} holds coefficients; `cowgpu convert "
                                                   "--rotate` turns those, and --length-unit says their unit",
                                                   option, request.mesh));
}

RawMesh load_mended(const std::string& mesh, const Mending& mending, Monitor& monitor) {
  RawMesh raw = load_mesh(mesh);
  mend(raw, mending, monitor);
  return raw;
}

Body load_body(const BodyRequest& request, std::vector<std::string>& notes, Monitor& monitor) {
  check_lengths(request);
  check_rotation(request.rotation, "the rotation from the file's axes");
  const auto add = [&](const std::vector<std::string>& more) { notes.insert(notes.end(), more.begin(), more.end()); };
  add(request.notes);
  Placement placement{{request.length_unit.value_or(1), 1, request.units_stated()}, request.rotation};
  RawMesh mesh = load_mended(request.mesh, request.mending, monitor);
  if (request.length) placement.units.metre = metres_per_unit(*request.length, mesh);
  place(mesh, placement);
  ClosedSurface surface = ClosedSurface::from(std::move(mesh));
  add(body_notes(surface, monitor));
  std::vector<Part> parts;
  for (const PartRequest& part : request.parts) parts.push_back(load_part(part, placement, monitor));
  for (const Part& part : parts)
    for (const std::string& note : body_notes(part.surface, monitor))
      notes.push_back(fmt::format("{}: {}", part.surface.mesh().name, note));
  Body body = make_body(std::move(surface), request.origin, request.density.value_or(1), std::move(parts));
  body.placement = placement;
  return body;
}

LoadedMass load_mass(const BodyRequest& request, Motion motion, Monitor& monitor) {
  LoadedMass loaded;
  if (is_coefficient_file(request.mesh)) {
    loaded = load_coefficients(request);
  } else {
    if (request.brillouin_radius)
      throw Error(Fault::bad_argument,
                  fmt::format("--brillouin-radius is for coefficients that do not say it; that of {} is measured",
                              request.mesh));
    loaded.mesh =
        motion == Motion::free ? load_free(request, loaded.notes, monitor) : load_body(request, loaded.notes, monitor);
    loaded.units = loaded.mesh->units();
    if (const std::string note = density_note(request, loaded.units); !note.empty()) loaded.notes.push_back(note);
  }
  loaded.name = request.mesh;
  return loaded;
}

void require_units(const LoadedMass& loaded) {
  if (loaded.units.stated) return;
  throw Error(
      Fault::bad_argument,
      fmt::format("no unit was stated for {}: give {} and a --density such as 1g/cm3; without them there are no "
                  "kilograms, metres and seconds",
                  loaded.name,
                  loaded.mesh ? "--length 2.5m (how long the body is) or --length-unit (what 1 in its file is)"
                              : "--length-unit (what 1 in the file is)"));
}

void check_multipole_order(int order) {
  if (order < least_multipole_order || order > largest_multipole_order)
    throw Error(Fault::bad_argument, fmt::format("the multipoles' order {} must be from {} to {}", order,
                                                 least_multipole_order, largest_multipole_order));
}

physics::RigidBody rigid_body(const LoadedMass& loaded) {
  return loaded.mesh ? physics::rigid_body(*loaded.mesh) : physics::rigid_body(*loaded.coefficients, loaded.units);
}

physics::RigidBody free_body(const LoadedMass& loaded, int order, Monitor& monitor) {
  return loaded.mesh ? physics::free_body(*loaded.mesh, order, monitor)
                     : physics::free_body(*loaded.coefficients, loaded.units, order);
}

Multipoles moments(const LoadedMass& loaded, int lmax, Backend& backend, Monitor& monitor) {
  if (loaded.mesh) return mass_moments(mass_problems(*loaded.mesh, lmax, default_cut_off), backend, monitor);
  Multipoles own = physics::mass_moments(*loaded.coefficients, lmax);
  const double metre = loaded.units.metre;
  return metre == 1 ? own : physics::in_si(std::move(own), metre, std::pow(metre, 3));
}

physics::Subject subject(const LoadedMass& loaded) {
  if (!loaded.mesh)
    return {fmt::format("coefficients {}, to degree {}", loaded.name, loaded.coefficients->lmax), "coefficients",
            loaded.name, "", loaded.notes};
  const RawMesh& mesh = loaded.mesh->surface.mesh();
  return {mesh_line(mesh), "mesh", mesh.name, mesh.sha256, loaded.notes};
}

std::string unknown_radius_note(const LoadedMass& loaded) {
  if (loaded.mesh || loaded.coefficients->brillouin_radius) return "";
  return fmt::format(
      "the file does not say the radius of the sphere that holds its body, inside of which the series is "
      "not the potential; its reference radius, {:.9g}, may be smaller or larger; --brillouin-radius "
      "states it, and keeps places out of that sphere",
      loaded.coefficients->reference_radius.value_or(0));
}

std::string density_note(const BodyRequest& request, const Units& units) {
  if (!units.stated || request.density || request.charge) return "";
  return "the density was not given: 1 kg/m3, of a body as light as air; --density 1g/cm3 is that of water";
}

} // namespace cowgpu
