#include "host/cli/body_options.hpp"

#include "host/cli/commands.hpp"
#include "host/cli/mend_options.hpp"
#include "host/cli/quantities.hpp"
#include "host/error.hpp"
#include "host/mesh/winding_notes.hpp"
#include "host/units.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace cowgpu::cli {
namespace {

// --length, read before there is a mesh to measure.
double parse_length(const BodyOptions& options) {
  if (!options.length_unit.empty())
    throw Error(Fault::bad_argument, "--length and --length-unit both say how large the body is; leave one out");
  const Measure length = parse_measure("--length", options.length, Dimension::length);
  if (!length.has_unit)
    throw Error(Fault::bad_argument,
                fmt::format("--length {}: it needs a unit; it is the body's length, such as 2.5m", options.length));
  if (!(length.value > 0))
    throw Error(Fault::bad_argument, fmt::format("--length {}: it must be above 0", options.length));
  return length.value;
}

double metres_per_unit(const BodyOptions& options, const RawMesh& mesh) {
  const double longest = bounding_box(mesh.vertices, mesh.faces).longest_side();
  if (!(longest > 0) || !std::isfinite(longest))
    throw Error(Fault::bad_argument, fmt::format("--length {}: {} has no length", options.length, mesh.name));
  return parse_length(options) / longest;
}

Placement parse_placement(const BodyOptions& options) {
  Placement placement;
  if (!options.length.empty()) {
    parse_length(options);
    placement.metric = true;
  }
  if (!options.length_unit.empty()) {
    placement.scale = parse_length_unit(options.length_unit);
    placement.metric = true;
  }
  if (!options.axes.empty()) placement.rotation = axes_rotation(options.axes);
  if (!options.rotate.empty()) placement.rotation = parse_rotation("--rotate", options.rotate) * placement.rotation;
  return placement;
}

double parse_density(std::string_view option, std::string_view text, bool metric, bool charge) {
  const Measure density = parse_measure(option, text, charge ? Dimension::charge_density : Dimension::density);
  if (density.has_unit && !metric)
    throw Error(
        Fault::bad_argument,
        fmt::format("{} {}: a density with a unit needs the mesh's: add --length-unit, the length that 1 in the "
                    "mesh's file stands for, such as mm or 2.3m, or --length",
                    option, text));
  return density.value;
}

ClosedSurface load_placed(const std::string& name, const Mending& mending, const Placement& placement) {
  RawMesh mesh = load_mended(name, mending);
  place(mesh, placement);
  return ClosedSurface::from(std::move(mesh));
}

struct PartChoice {
  std::string mesh, density;
};

PartChoice parse_part(const std::string& text) {
  const std::size_t sign = text.rfind('=');
  if (sign == std::string::npos || sign == 0 || sign + 1 == text.size())
    throw Error(Fault::bad_argument,
                fmt::format("--part {}: it takes FILE=DENSITY, a mesh and what it adds to the density inside, such as "
                            "rumen.off=300 or hole.off=-1000",
                            text));
  return {text.substr(0, sign), text.substr(sign + 1)};
}

Part load_part(const std::string& text, const Placement& placement, bool charge) {
  const PartChoice choice = parse_part(text);
  const double density = parse_density("--part " + choice.mesh, choice.density, placement.metric, charge);
  try {
    return Part(load_placed(choice.mesh, {}, placement), density);
  } catch (const Error& error) {
    throw Error(error.fault(), fmt::format("--part {}: {}", text, error.what()));
  }
}

} // namespace

void add_body_options(Command& command, BodyOptions& options) {
  command.add_option("mesh", options.mesh, mesh_help())->type_name("MESH")->capture_default_str();
  command
      .add_option("--origin", options.origin,
                  "com (centre of mass, of the parts too), mesh, or X,Y,Z in the body's coordinates")
      ->capture_default_str();
  command
      .add_option("--density", options.density,
                  "Mass per cubed length unit of the mesh; with --length-unit in kg/m3, or with a unit: 2.7g/cm3")
      ->capture_default_str();
  command
      .add_option("--length-unit", options.length_unit,
                  "The length that 1 in the file stands for, of a mesh or of coefficients that do not say it: mm, km, "
                  "2.3m ...; "
                  "results are in metres and kilograms")
      ->type_name("LENGTH")
      ->check(not_empty());
  command
      .add_option("--length", options.length,
                  "How long the body of MESH is, along the longest side of its box: 2.5m; instead of --length-unit")
      ->type_name("LENGTH")
      ->check(not_empty());
  command
      .add_option("--axes", options.axes,
                  "The mesh's axes that become x, y and z: x,-z,y for x' = x, y' = -z, z' = y (right-handed, exact)")
      ->type_name("A,B,C")
      ->check(not_empty());
  command
      .add_option("--rotate", options.rotate,
                  "Turn the body, after --axes: R_z(ALPHA) R_y(BETA) R_z(GAMMA), degrees, about fixed axes, the "
                  "rightmost first")
      ->type_name("ALPHA,BETA,GAMMA")
      ->check(not_empty());
  command
      .add_option("--part", options.parts,
                  "A part FILE=DENSITY: DENSITY is added inside its surface (negative: a hole); can be repeated. "
                  "Units, axes and attitude are those of MESH")
      ->type_name("FILE=DENSITY")
      ->allow_extra_args(false);
  add_mend_options(command, options.mending);
}

Body load_body(const BodyOptions& options, std::vector<std::string>& notes) {
  const OriginChoice origin = parse_origin(options.origin);
  if (!options.length.empty()) note_unit("--length", options.length, Dimension::length, notes);
  if (options.length_unit.ends_with("R_earth"))
    notes.push_back(fmt::format("--length-unit {}: {}", options.length_unit, meaning("R_earth")));
  Placement placement = parse_placement(options);
  const double density = parse_density("--density", options.density, placement.metric, options.charge);
  RawMesh mesh = load_mended(options.mesh, options.mending);
  if (!options.length.empty()) placement.scale = metres_per_unit(options, mesh);
  place(mesh, placement);
  ClosedSurface surface = ClosedSurface::from(std::move(mesh));
  ConsoleMonitor monitor(ProgressStyle::none);
  const auto add = [&](const std::vector<std::string>& more) { notes.insert(notes.end(), more.begin(), more.end()); };
  add(body_notes(surface, monitor));
  std::vector<Part> parts;
  for (const std::string& text : options.parts) parts.push_back(load_part(text, placement, options.charge));
  for (const Part& part : parts)
    for (const std::string& note : body_notes(part.surface, monitor))
      notes.push_back(fmt::format("{}: {}", part.surface.mesh().name, note));
  Body body = make_body(std::move(surface), origin, density, std::move(parts));
  body.placement = placement;
  return body;
}

StatedUnits stated_units(const BodyOptions& options) {
  const Placement placement = parse_placement(options);
  return {placement.scale, parse_density("--density", options.density, placement.metric, options.charge),
          placement.metric};
}

std::vector<std::string> input_files(const BodyOptions& options) {
  std::vector<std::string> files = {options.mesh};
  for (const std::string& part : options.parts) files.push_back(parse_part(part).mesh);
  return files;
}

} // namespace cowgpu::cli
