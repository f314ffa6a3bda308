#include "host/cli/body_options.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/quantities.hpp"
#include "host/cli/spin_options.hpp"
#include "host/requests/surface_gravity.hpp"

#include "host/error.hpp"
#include "host/io/document_json.hpp"
#include "host/io/mesh_values_file.hpp"
#include "host/io/point_file.hpp"
#include "host/report/findings_report.hpp"
#include "host/report/result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace cowgpu::cli {
namespace {

struct Options {
  BodyOptions body;
  SpinOptions spin;
  std::string at = "faces", height, colour;
  std::vector<std::string> outputs;
  double tolerance = default_surface_tolerance;
  bool guarantee = false, json = false, dry_run = false;
};

void read_places(const Options& options, SurfaceGravityRequest& request) {
  if (options.at == "faces") {
    request.place = ValuePlace::faces;
  } else if (options.at == "vertices") {
    request.place = ValuePlace::vertices;
  } else {
    request.place = ValuePlace::points;
    request.points = read_points(options.at);
    request.points_name = options.at == "-" ? "standard input" : options.at;
  }
  if (!options.height.empty()) request.height = parse_measure("--height", options.height, Dimension::length);
}

SurfaceGravityRequest request_of(const Options& options, const Common& common) {
  SurfaceGravityRequest request;
  request.body = body_request(options.body);
  read_places(options, request);
  request.mass = stated_mass(options.spin);
  request.spin_rate = spin_rate(options.spin, request.notes);
  request.spin_axis = spin_axis(options.spin);
  request.tolerance = options.tolerance;
  request.guarantee = options.guarantee;
  request.threads = common.threads;
  return request;
}

void write_plan(const SurfaceGravityPlan& plan, const Backend& backend) {
  const MemoryNeed need = plan.memory(backend);
  std::size_t faces = plan.body().surface.faces().size();
  for (const Part& part : plan.body().parts) faces += part.surface.faces().size();
  write_stdout(fmt::format("plan: gravity of {} faces at {} places, {}\n", faces, plan.places,
                           plan.request.tolerance == 0 ? std::string("all faces summed at each")
                                                       : fmt::format("to {} of G M/R^2{}", plan.request.tolerance,
                                                                     plan.request.guarantee ? ", proven" : "")));
  write_stdout("device: " + device_line(backend.facts()) + "\n");
  write_stdout(fmt::format("memory: at most {} MiB on the host, files and all, and {} MiB on the device\n",
                           (need.host >> 20) + 1, (need.device + (1 << 20) - 1) >> 20));
}

// One file after the other is written.
std::uint64_t file_memory(const Options& options, const SurfaceGravityPlan& plan) {
  std::uint64_t most = 0;
  const bool points = plan.request.place == ValuePlace::points;
  const std::uint64_t vertices = points ? plan.places : plan.body().surface.vertices().size(),
                      faces = points ? 0 : plan.body().surface.faces().size();
  for (const std::string& output : options.outputs)
    most = std::max(most, mesh_values_file_memory(mesh_values_format(output), plan.request.place, vertices, faces,
                                                  surface_gravity_numbers(plan.request.place, plan.request.guarantee)));
  return most;
}

void check_outputs(const Options& options) {
  for (const std::string& output : options.outputs) {
    if (output == "-") throw Error(Fault::bad_argument, "-o -: the standard output has the report; name a file");
    const bool points = options.at != "faces" && options.at != "vertices";
    if (mesh_values_format(output) == MeshValuesFormat::glb && points)
      throw Error(Fault::bad_argument,
                  fmt::format("-o {}: GLB shows surfaces, and --at {} are points: take .vtp, .ply, "
                              ".csv or .nc",
                              output, options.at));
    const std::string beside = output + ".json"; // goes with a CSV
    for (const std::string& name : input_files(options.body)) {
      refuse_mesh_as_output(name, output);
      refuse_mesh_as_output(name, beside);
    }
    refuse_same_file(options.at, output);
    refuse_same_file(options.at, beside);
    if (std::count(options.outputs.begin(), options.outputs.end(), output) > 1)
      throw Error(Fault::bad_argument, fmt::format("-o {} is named more than once", output));
  }
}

void run(const Options& options, const Common& common) {
  check_outputs(options);
  SurfaceGravityRequest request = request_of(options, common);
  std::vector<std::unique_ptr<MeshValuesFile>> files;
  if (!options.dry_run)
    for (const std::string& output : options.outputs) files.push_back(std::make_unique<MeshValuesFile>(output));
  ConsoleMonitor monitor(common.style());
  std::string note;
  const auto backend = open_backend(common, &note);
  if (!note.empty()) request.notes.push_back(note);
  if (!common.quiet && !note.empty()) say(fmt::format("cowgpu: {}\n", note));
  SurfaceGravityPlan plan = plan_surface_gravity(std::move(request), monitor);
  plan.extra_bytes = file_memory(options, plan);
  if (options.dry_run) {
    check_memory(plan.memory(*backend), *backend, "take a coarser mesh, or fewer points");
    write_plan(plan, *backend);
    return;
  }
  const SurfaceGravityResult result = surface_gravity(std::move(plan), *backend, monitor);
  monitor.clear();
  const physics::Findings found = findings(result);
  for (std::size_t i = 0; i < files.size(); ++i) {
    files[i]->write(result.values, options.colour, monitor);
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.outputs[i]));
  }
  if (options.json)
    write_json(document(found, "cowgpu.surface.v1", common.command), write_stdout);
  else
    write_findings(found, write_stdout);
}

} // namespace

void add_surface(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand(
      "surface",
      "Gravity on the surface of a body: potential, g, slope and elevation at each face or vertex, or at points");
  add_body_options(*command, options->body);
  command
      ->add_option(
          "--at", options->at,
          "faces (their centroids), vertices, or a text file of points in the body's coordinates, one a line (- for "
          "standard input)")
      ->type_name("PLACES")
      ->check(not_empty())
      ->capture_default_str();
  command->add_option("--height", options->height, "So far above faces or vertices, along their normals: 10m")
      ->type_name("LENGTH")
      ->check(not_empty());
  add_spin_options(*command, options->spin, "--origin");
  command
      ->add_option("--tolerance", options->tolerance,
                   "Error allowed of g, as a part of G M/R^2: 1e-12 to 1e-2, or 0 to sum all faces everywhere")
      ->type_name("PART")
      ->capture_default_str();
  command->add_flag("--guarantee", options->guarantee,
                    "What is left out of g is proven to stay below the tolerance; each place's bound goes to the file");
  command
      ->add_option("-o,--output", options->outputs,
                   "Values at all places: FILE.vtp, FILE.ply, FILE.glb, FILE.csv or FILE.nc; can be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false);
  command
      ->add_option("--colour", options->colour,
                   "Quantity that PLY and GLB files are coloured by: slope (of faces and vertices the default), g, "
                   "elevation ...")
      ->type_name("NAME")
      ->check(one_of({"potential", "g", "geopotential", "slope", "elevation", "escape_speed", "tilt", "g_bound"}));
  command->add_flag("--json", options->json, "The summary as JSON (data/schemas/cowgpu.surface.v1.json)");
  command->add_flag("--dry-run", options->dry_run, "Print the plan and the memory it needs, and stop");
  add_common_options(*command, common);
  command->footer("Examples: cowgpu surface eros.tab --length-unit km --density 2.67g/cm3 --period 5.27h -o eros.vtp\n"
                  "          cowgpu surface builtin:cow --length 2.5m --density 1g/cm3 --at vertices -o cow.csv\n"
                  "          cowgpu surface builtin:ellipsoid:3,2,1 --omega 0.5 --guarantee --json");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
