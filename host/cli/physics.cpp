#include "host/cli/physics.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/mesh_source.hpp"
#include "host/physics/paper.hpp"
#include "host/physics/potential.hpp"
#include "host/report/findings_report.hpp"
#include "host/report/json_parts.hpp"
#include "host/spectrum/mass_moments.hpp"
#include "host/units.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace cowgpu::cli {
namespace {

// A new application is a row here, a file in host/physics, one in host/cli and a schema.
constexpr std::array applications = {
    Application{"tensors", "Quadrupole, inertia, second moment and principal axes of a body, or from its multipoles",
                "Examples: cowgpu tensors benchmark\n"
                "          cowgpu expand benchmark --lmax 2 -o cow.json && cowgpu tensors cow.json --json\n"
                "          cowgpu tensors benchmark --recipe paper",
                add_tensors},
    Application{"potential",
                "Potential, acceleration and gravity gradient outside a body, and how good its multipoles are there",
                "Examples: cowgpu potential benchmark --length 2.5m --density 1g/cm3 --at 3,0,0\n"
                "          cowgpu potential benchmark --sphere 1.5R --resolution 61 -o sphere.nc\n"
                "          cowgpu potential benchmark --plane z,0,1,101 --inside exact -o plane.csv\n"
                "          cowgpu potential benchmark --errors --plot errors.svg",
                add_potential, true, true},
    Application{"radiate", "Gravitational waves from a body that turns: their power, and how long until it has stopped",
                "Examples: cowgpu radiate benchmark --length 2.5m --density 1g/cm3 --axis y --omega 1rad/s\n"
                "          cowgpu radiate benchmark --recipe paper",
                add_radiate, false, true},
    Application{
        "tides", "A body on a circular orbit: gravity-gradient torque, attitudes that last, librations, locking",
        "Examples: cowgpu tides benchmark --length 2.5m --density 1g/cm3 --orbit 6771km\n"
        "          cowgpu tides benchmark --length 2.5m --density 1g/cm3 --orbit 400000km --mass 6e24kg --attitude "
        "z:30\n"
        "          cowgpu tides cow.json --length-unit 2.4m --density 1g/cm3 --orbit 42164km --love 0.1 --quality 10 "
        "--spin 1rad/s",
        add_tides, false, true},
    Application{
        "drop", "Whether a body that is dropped lands on its feet: its fall, turned by the gradient of gravity",
        "Examples: cowgpu drop benchmark --length 2.5m --density 1g/cm3 --height 10m --attitude upside-down\n"
        "          cowgpu drop benchmark --length 2.5m --density 1g/cm3 --height 10m --attitude on-side --spin x,10rpm",
        add_drop},
    Application{"tip", "What tips a standing body over onto its side: the least force, and the least push that lasts",
                "Examples: cowgpu tip benchmark --length 2.5m --density 1g/cm3 --friction 0.6 --push 5000N:0.1s\n"
                "          cowgpu tip benchmark --length 2.5m --density 1g/cm3 --of stretch --order 0..8 --json\n"
                "          cowgpu tip benchmark --recipe paper\n"
                "y is up, x forward and right is +z: the body falls to a side about an axis along x, and pushes are\n"
                "at right angles to x. Without a unit of length forces are in units of the body's weight, and newtons\n"
                "are not known: --length or --length-unit give them, with --density. A unit of length without\n"
                "--density leaves 1 kg/m3, a body as light as air.",
                add_tip},
};

// The paper's body, but for what the user says.
void take_paper_body(Command& command, BodyOptions& body) {
  if (command.get_option("mesh")->count() == 0) body.mesh = physics::paper::mesh;
  if (is_coefficient_file(body.mesh))
    throw Error(Fault::bad_argument, "--recipe paper is about the paper's mesh, and this is a file of coefficients");
  if (body.length_unit.empty() && body.length.empty()) body.length_unit = physics::paper::length_unit;
  if (command.get_option("--density")->count() == 0) body.density = physics::paper::density;
}

// Its numbers are those of its body as it stands in its file.
void keep_paper_to_its_body(const PhysicsOptions& options, physics::Findings& findings) {
  const BodyOptions& body = options.body;
  if (findings.input_sha256 == benchmark_sha256 && body.axes.empty() && body.rotate.empty() && body.parts.empty())
    return;
  findings.paper.clear();
  findings.notes.push_back(fmt::format("--recipe paper: units and settings are the paper's, but its numbers are about "
                                       "its own mesh as it is, and {} cannot be compared with them",
                                       body.mesh));
}

void add_application(Command& app, Common& common, const Application& application) {
  Command* command = app.add_subcommand(application.name, application.summary);
  const auto options = std::make_shared<PhysicsOptions>();
  add_body_options(*command, options->body);
  command->get_option("mesh")->description("Coefficients of its mass (JSON, CSV, netCDF, ICGEM's .gfc, SHTOOLS text or "
                                           "a gravity table, recognised by their content), or a mesh: " +
                                           command->get_option("mesh")->get_description());
  command->get_option("mesh")->type_name("MESH|COEFFS");
  const Solve solve = application.add(*command, common);
  if (application.asks_radius)
    command
        ->add_option("--brillouin-radius", options->brillouin_radius,
                     "Radius of the sphere about the origin of the coefficients that holds the body, in their "
                     "coordinates, where they do not say it; nothing is computed inside")
        ->type_name("R");
  command
      ->add_option("--recipe", options->recipe,
                   "default, or paper: as Higher multipoles of the cow has it (benchmark, 2.39 m, 1 g/cm3), with its "
                   "numbers beside those of its mesh")
      ->check(one_of({"default", "paper"}))
      ->capture_default_str();
  command->add_flag("--json", options->json, fmt::format("As JSON (data/schemas/cowgpu.{}.v1.json)", application.name));
  command->footer(application.footer);
  command->callback([=, &common] {
    options->density_given = options->paper() || command->get_option("--density")->count() > 0;
    if (options->paper()) take_paper_body(*command, options->body);
    physics::Findings findings = solve(*options);
    if (options->paper() && !application.paper_of_formulas) keep_paper_to_its_body(*options, findings);
    check_stop(ConsoleMonitor(ProgressStyle::none));
    if (options->json)
      write_stdout(json_text(findings_json(findings, fmt::format("cowgpu.{}.v1", application.name), common.command)) +
                   "\n");
    else
      write_findings(findings, write_stdout);
  });
}

} // namespace

void refuse_placing(const BodyOptions& body) {
  for (const auto& [given, option] :
       {std::pair(body.origin != "com", "--origin"), std::pair(!body.length.empty(), "--length"),
        std::pair(!body.axes.empty(), "--axes"), std::pair(!body.rotate.empty(), "--rotate"),
        std::pair(!body.parts.empty(), "--part")})
    if (given)
      throw Error(Fault::bad_argument, fmt::format("{} places a mesh, and {} holds coefficients; `cowgpu convert "
                                                   "--rotate` turns those, and --length-unit says their unit",
                                                   option, body.mesh));
}

namespace {

// A file's body with the density that the user states instead of its own.
void restate_density(const PhysicsOptions& options, CoefficientSet& set) {
  if (set.length_unit == "m" && set.mass_unit == "kg")
    throw Error(Fault::bad_argument,
                fmt::format("--density: {} is in kilograms already, and its density stands", options.body.mesh));
  const double density = stated_units(options.body).density, factor = density / set.density.value_or(1);
  if (set.kind == CoefficientKind::multipoles) {
    for (double& value : set.first) value *= factor;
    for (double& value : set.second) value *= factor;
  }
  set.density = density;
  for (std::optional<double>* of_mass : {&set.mass, &set.second_moment, &set.gm})
    if (*of_mass) **of_mass *= factor;
}

// What the user says of the sphere that holds a file's body.
void state_radius(const PhysicsOptions& options, const StatedUnits& stated, CoefficientSet& set) {
  const std::string& text = options.brillouin_radius;
  if (text.empty()) return;
  const Measure radius = parse_measure("--brillouin-radius", text, Dimension::length);
  const bool metres = set.length_unit == "m";
  if (radius.has_unit && !metres && !stated.metric)
    throw Error(Fault::bad_argument, fmt::format("--brillouin-radius {}: a length with a unit needs that of the file: "
                                                 "add --length-unit, or give a bare number in the file's unit",
                                                 text));
  if (!(radius.value > 0))
    throw Error(Fault::bad_argument, fmt::format("--brillouin-radius {}: it must be above 0", text));
  // The unit is stated for coordinates too, so that a bare number is in metres then.
  const double value = metres || !stated.metric ? radius.value : radius.value / stated.metres;
  if (set.brillouin_radius && std::abs(value - *set.brillouin_radius) > 1e-9 * value)
    throw Error(Fault::bad_argument, fmt::format("--brillouin-radius {}: {} says that it is {}, in its unit of length",
                                                 text, options.body.mesh, *set.brillouin_radius));
  if (!set.brillouin_radius) set.brillouin_radius = value;
}

// The units that the options state and that are not in the numbers yet: those of a file without units are.
StatedUnits units_beside(const PhysicsInput& input, const PhysicsOptions& options) {
  StatedUnits stated = stated_units(options.body);
  if (input.coefficients && !input.coefficients->units_stated) stated.metric = false;
  return stated;
}

} // namespace

PhysicsInput load_input(const PhysicsOptions& options) {
  const BodyOptions& body = options.body;
  PhysicsInput input;
  if (!is_coefficient_file(body.mesh)) {
    if (!options.brillouin_radius.empty())
      throw Error(
          Fault::bad_argument,
          fmt::format("--brillouin-radius is for coefficients that do not say it; that of {} is measured", body.mesh));
    input.body = load_body(body, input.notes);
    return input;
  }
  const StatedUnits stated = stated_units(body);
  refuse_placing(body);
  input.coefficients = read_coefficient_set(body.mesh, "", stated.metric ? std::optional(stated.metres) : std::nullopt);
  input.notes = input.coefficients->notes;
  if (options.density_given && input.coefficients->kind != CoefficientKind::field)
    restate_density(options, *input.coefficients);
  state_radius(options, stated, *input.coefficients);
  return input;
}

std::string unknown_radius_note(const PhysicsInput& input) {
  if (input.body || input.coefficients->brillouin_radius) return "";
  return fmt::format(
      "the file does not say the radius of the sphere that holds its body, inside of which the series is "
      "not the potential; its reference radius, {:.9g}, may be smaller or larger; --brillouin-radius "
      "states it, and keeps places out of that sphere",
      input.coefficients->reference_radius.value_or(0));
}

PhysicsInput load_free_body(const PhysicsOptions& options) {
  if (is_coefficient_file(options.body.mesh)) return load_input(options);
  PhysicsOptions own = options;
  own.body.origin = "mesh"; // without a mass there is no other
  PhysicsInput input = load_input(own);
  Body& body = *input.body;
  if (!body.centre_of_mass.allFinite())
    throw Error(
        Fault::bad_argument,
        fmt::format("{} and its parts weigh {:.3g} together, nothing or nothing but rounding: a free body turns "
                    "about its centre of mass, and this has none; change --density or the density of a --part",
                    options.body.mesh, body.mass()));
  const Placement placement = body.placement;
  body = make_body(std::move(body.surface), {}, body.density, std::move(body.parts));
  body.placement = placement;
  if (options.body.origin != "com")
    input.notes.push_back("--origin changes nothing: a free body turns about its centre of mass");
  return input;
}

PlacedTensors placed_tensors(const PhysicsInput& input, const PhysicsOptions& options) {
  PlacedTensors placed;
  if (input.body) {
    placed.tensors = physics::mass_tensors(*input.body);
    const double metres = input.body->placement.scale;
    if (!input.body->placement.metric) return placed;
    placed.unit_m = metres;
    placed.unit_kg = input.body->density * metres * metres * metres;
    return placed;
  }
  const StatedUnits stated = units_beside(input, options);
  placed.tensors = physics::mass_tensors(*input.coefficients);
  if (placed.tensors.metric()) {
    if (stated.metric)
      throw Error(Fault::bad_argument,
                  fmt::format("--length-unit: {} is in metres and kilograms already", options.body.mesh));
    placed.unit_m = placed.unit_kg = 1;
    return placed;
  }
  if (!stated.metric) return placed;
  placed.unit_m = stated.metres;
  const double volume = std::pow(stated.metres, 3); // the density is in the numbers
  placed.unit_kg = input.coefficients->density.value_or(1) * volume;
  placed.tensors = physics::in_si(placed.tensors, stated.metres, volume);
  return placed;
}

PlacedTensors metric_tensors(const PhysicsInput& input, const PhysicsOptions& options) {
  PlacedTensors placed = placed_tensors(input, options);
  if (!placed.tensors.metric())
    throw Error(
        Fault::bad_argument,
        fmt::format("no unit was stated for {}: give {} and a --density such as 1g/cm3; without them there are no "
                    "kilograms, metres and seconds",
                    options.body.mesh,
                    input.body ? "--length 2.5m (how long the body is) or --length-unit (what 1 in its file is)"
                               : "--length-unit (what 1 in the file is)"));
  return placed;
}

physics::MassiveBody massive_body(const PhysicsInput& input, const PlacedTensors& placed, int order) {
  if (!input.body)
    return physics::massive_body(*input.coefficients, placed.tensors, *placed.unit_m, std::pow(*placed.unit_m, 3),
                                 order);
  ConsoleMonitor monitor(ProgressStyle::none);
  return physics::massive_body(*input.body, order, monitor);
}

PlacedMoments placed_moments(const PhysicsInput& input, const PhysicsOptions& options, int lmax, Backend& backend,
                             Monitor& monitor) {
  PlacedMoments placed;
  if (input.body) {
    placed.moments = mass_moments(mass_problems(*input.body, lmax, default_cut_off), backend, monitor);
    placed.metric = input.body->placement.metric;
    return placed;
  }
  const CoefficientSet& set = *input.coefficients;
  const StatedUnits stated = units_beside(input, options);
  placed.moments = physics::mass_moments(set, lmax);
  placed.radius_known = set.brillouin_radius.has_value();
  placed.metric = set.length_unit == "m" && set.mass_unit == "kg";
  if (placed.metric && options.body.charge)
    throw Error(
        Fault::bad_argument,
        fmt::format("--charge: {} holds a mass in kilograms; expand the body without units, and state them here "
                    "with --length-unit and --density",
                    options.body.mesh));
  if (placed.metric && stated.metric)
    throw Error(Fault::bad_argument,
                fmt::format("--length-unit: {} is in metres and kilograms already", options.body.mesh));
  if (placed.metric || !stated.metric) return placed;
  placed.metric = true;
  placed.metres = stated.metres;
  placed.moments = physics::in_si(std::move(placed.moments), stated.metres, std::pow(stated.metres, 3));
  return placed;
}

physics::Findings findings_about(const PhysicsInput& input, const PhysicsOptions& options) {
  physics::Findings findings;
  findings.notes = input.notes;
  if (input.body) {
    const RawMesh& mesh = input.body->surface.mesh();
    findings.title = mesh_line(mesh);
    findings.input_kind = "mesh";
    findings.input_name = mesh.name;
    findings.input_sha256 = mesh.sha256;
  } else {
    findings.title = fmt::format("coefficients {}, to degree {}", options.body.mesh, input.coefficients->lmax);
    findings.input_kind = "coefficients";
    findings.input_name = options.body.mesh;
  }
  if (input.body)
    note_density(options, input.body->placement.metric, findings.notes);
  else if (units_beside(input, options).metric && !options.density_given && !options.body.charge)
    findings.notes.push_back(fmt::format("the density was not given: that of the file, {:.6g}, is taken as kg/m3",
                                         input.coefficients->density.value_or(1)));
  return findings;
}

void note_density(const PhysicsOptions& options, bool metric, std::vector<std::string>& notes) {
  if (metric && !options.density_given && !options.body.charge)
    notes.push_back("the density was not given: 1 kg/m3, of a body as light as air; --density 1g/cm3 is that of water");
}

void add_physics(Command& app, Common& common) {
  for (const Application& application : applications) add_application(app, common, application);
}

} // namespace cowgpu::cli
