#include "host/cli/body_options.hpp"

#include "host/cli/commands.hpp"
#include "host/cli/mend_options.hpp"
#include "host/cli/quantities.hpp"
#include "host/error.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

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

PartRequest parse_part(const std::string& text) {
  const std::size_t sign = text.rfind('=');
  if (sign == std::string::npos || sign == 0 || sign + 1 == text.size())
    throw Error(Fault::bad_argument,
                fmt::format("--part {}: it takes FILE=DENSITY, a mesh and what it adds to the density inside, such as "
                            "rumen.off=300 or hole.off=-1000",
                            text));
  return {text.substr(0, sign), 0};
}

} // namespace

void add_body_options(Command& command, BodyOptions& options) {
  command.add_option("mesh", options.mesh, mesh_help())->type_name("MESH")->capture_default_str();
  command
      .add_option("--origin", options.origin,
                  "com (centre of mass, of the parts too), mesh, or X,Y,Z in the body's coordinates")
      ->capture_default_str();
  options.density_option =
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

BodyRequest body_request(const BodyOptions& options) {
  BodyRequest request;
  request.mesh = options.mesh;
  request.mending = options.mending;
  request.origin = parse_origin(options.origin);
  if (!options.length.empty()) {
    note_unit("--length", options.length, Dimension::length, request.notes);
    request.length = parse_length(options);
  }
  if (options.length_unit.ends_with("R_earth"))
    request.notes.push_back(fmt::format("--length-unit {}: {}", options.length_unit, meaning("R_earth")));
  request.length_unit = stated_metres(options.length_unit);
  if (!options.axes.empty()) request.rotation = axes_rotation(options.axes);
  if (!options.rotate.empty()) request.rotation = parse_rotation("--rotate", options.rotate) * request.rotation;
  const bool si = request.units_stated();
  request.charge = options.charge;
  const double density = parse_density("--density", options.density, si, options.charge);
  if (options.density_stated || (options.density_option && options.density_option->count() > 0))
    request.density = density;
  for (const std::string& text : options.parts) {
    request.parts.push_back(parse_part(text));
    PartRequest& part = request.parts.back();
    part.density = parse_density("--part " + part.mesh, text.substr(part.mesh.size() + 1), si, options.charge);
  }
  return request;
}

std::vector<std::string> input_files(const BodyOptions& options) {
  std::vector<std::string> files = {options.mesh};
  for (const std::string& part : options.parts) files.push_back(parse_part(part).mesh);
  return files;
}

std::vector<std::string> input_files(const BodyRequest& request) {
  std::vector<std::string> files = {request.mesh};
  for (const PartRequest& part : request.parts) files.push_back(part.mesh);
  return files;
}

} // namespace cowgpu::cli
