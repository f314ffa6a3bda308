#include "host/cli/physics.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/io/document_json.hpp"
#include "host/io/mesh_source.hpp"
#include "host/requests/paper_recipe.hpp"

#include <fmt/format.h>

#include <array>

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
    Application{"equilibria",
                "Where a particle stays at rest on or about a spinning body, inside it too, and whether it stays there",
                "Examples: cowgpu equilibria eros.tab --length-unit km --density 2.67g/cm3 --period 5.27h\n"
                "          cowgpu equilibria builtin:ellipsoid:3,2,1@3 --omega 0.7 --json",
                add_equilibria},
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
  const BodyRequest paper = paper_body();
  if (command.get_option("mesh")->count() == 0) body.mesh = paper.mesh;
  if (is_coefficient_file(body.mesh))
    throw Error(Fault::bad_argument, "--recipe paper is about the paper's mesh, and this is a file of coefficients");
  if (body.length_unit.empty() && body.length.empty()) body.length_unit = fmt::format("{}m", *paper.length_unit);
  if (body.density_option->count() == 0) body.density = fmt::format("{}kg/m3", *paper.density);
  body.density_stated = true;
}

// Its numbers are those of its body as it stands in its file.
void keep_paper_to_its_body(const BodyRequest& body, physics::Findings& findings) {
  if (findings.input_sha256 == benchmark_sha256 && body.rotation.isIdentity(0) && body.parts.empty()) return;
  findings.paper.clear();
  findings.notes.push_back(fmt::format("--recipe paper: units and settings are the paper's, but its numbers are about "
                                       "its own mesh as it is, and {} cannot be compared with them",
                                       body.mesh));
}

struct PhysicsOptions {
  BodyOptions body; ///< body.mesh is MESH|COEFFS
  std::string recipe = "default";
  std::string brillouin_radius; ///< as typed; for files that do not say it
  bool json = false;
};

PhysicsCall call_of(const PhysicsOptions& options) {
  PhysicsCall call{body_request(options.body), options.recipe == "paper", options.json};
  if (!options.brillouin_radius.empty())
    call.body.brillouin_radius = parse_measure("--brillouin-radius", options.brillouin_radius, Dimension::length);
  return call;
}

void add_application(Command& app, Common& common, const Application& application) {
  Command* command = app.add_subcommand(application.name, application.summary);
  const auto options = std::make_shared<PhysicsOptions>();
  add_body_options(*command, options->body);
  command->get_option("mesh")->description("Coefficients of its mass (JSON, CSV, netCDF, ICGEM's .gfc, SHTOOLS text or "
                                           "a gravity table, recognised by their content), or a mesh: " +
                                           command->get_option("mesh")->get_description());
  command->get_option("mesh")->type_name("MESH|COEFFS");
  const Solve solve = application.add(*command, common, options->body);
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
    if (options->recipe == "paper") take_paper_body(*command, options->body);
    const PhysicsCall call = call_of(*options);
    physics::Findings findings = solve(call);
    if (call.paper && !application.paper_of_formulas) keep_paper_to_its_body(call.body, findings);
    check_stop(ConsoleMonitor(ProgressStyle::none));
    if (options->json)
      write_json(document(findings, fmt::format("cowgpu.{}.v1", application.name), common.command), write_stdout);
    else
      write_findings(findings, write_stdout);
  });
}

} // namespace

void add_physics(Command& app, Common& common) {
  for (const Application& application : applications) add_application(app, common, application);
}

} // namespace cowgpu::cli
