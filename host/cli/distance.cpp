#include "host/requests/distance.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/mend_options.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/document_json.hpp"
#include "host/io/point_file.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string mesh = "builtin:cow", points, output;
  Mending mending;
  std::size_t grid = 0;
  bool without_sign = false, json = false, dry_run = false;
};

void write_plan(const DistancePlan& plan, const Backend& backend) {
  const MemoryNeed need = plan.memory(backend);
  const DistanceResult& empty = plan.result;
  write_stdout(fmt::format("plan: {} distances of {} points from {} triangles\n",
                           empty.with_sign ? "signed" : "unsigned", plan.count, empty.mesh.faces.size()));
  if (empty.lattice) write_stdout("grid: " + lattice_text(*empty.lattice) + "\n");
  write_stdout("device: " + device_line(backend.facts()) + "\n");
  write_stdout(fmt::format("memory: at most {} MiB on the host, files and all, and {} MiB on the device\n",
                           (need.host >> 20) + 1, (need.device + (1 << 20) - 1) >> 20));
}

void run(const Options& options, const Common& common) {
  if (options.points.empty() == (options.grid == 0))
    throw Error(Fault::bad_argument, "either POINTS or --grid says where distances are wanted, and not both");
  const bool to_stdout = options.output == "-";
  if (to_stdout && options.json)
    throw Error(Fault::bad_argument, "--json and -o - both write to the standard output; name a file");
  const FileFormat format = options.output.empty() || to_stdout ? FileFormat::csv : file_format(options.output);
  std::unique_ptr<AtomicFile> file;
  if (!to_stdout) {
    refuse_mesh_as_output(options.mesh, options.output);
    refuse_same_file(options.points, options.output);
  }
  if (!options.output.empty() && !to_stdout && !options.dry_run) file = std::make_unique<AtomicFile>(options.output);

  auto start = Clock::now();
  DistanceRequest request;
  ConsoleMonitor monitor(common.style());
  request.mesh = load_mended(options.mesh, options.mending, monitor);
  if (options.grid)
    request.lattice = options.grid;
  else
    request.points = read_points(options.points);
  request.with_sign = !options.without_sign;
  request.threads = common.threads;
  DistancePlan plan(std::move(request), monitor);
  plan.result.read_seconds = seconds_since(start);

  start = Clock::now();
  std::string note;
  const auto backend = open_backend(common, &note);
  const double open_seconds = seconds_since(start);
  if (!note.empty()) plan.result.notes.push_back(note);
  if (!common.quiet && !note.empty()) say(fmt::format("cowgpu: {}\n", note));
  if (options.dry_run) {
    check_distance_memory(plan, *backend);
    write_plan(plan, *backend);
    return;
  }
  DistanceResult result = find_distances(std::move(plan), *backend, monitor);
  monitor.clear();
  result.setup_seconds += open_seconds;
  result.input = options.points;
  result.output = options.output;

  start = Clock::now();
  if (to_stdout) {
    write_distances_csv(result.table(), write_stdout);
    return;
  }
  if (file) {
    if (format == FileFormat::csv)
      write_distances_csv(result.table(), [&](std::string_view text) {
        check_stop(monitor);
        file->write(text);
      });
    else
      write_distances(result.table(), format, *file);
    check_stop(monitor);
    file->commit();
    result.write_seconds = seconds_since(start);
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  }
  if (options.json)
    write_json(document(result, common.command), write_stdout);
  else
    write_distance(result, write_stdout);
}

} // namespace

void add_distance(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command =
      app.add_subcommand("distance", "Signed distances of points from a surface, and the closest points of it");
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->required();
  add_mend_options(*command, options->mending);
  command
      ->add_option("points", options->points,
                   "Text file of points, one a line: x,y,z (or columns named so); - for standard input")
      ->type_name("POINTS");
  command
      ->add_option("--grid", options->grid,
                   "Instead of POINTS a lattice: N points along the longest side of the bounding box enlarged by 1.1")
      ->check(in_range(least_lattice, most_lattice))
      ->type_name("N");
  command
      ->add_option("-o,--output", options->output,
                   "Distances and closest points: FILE.csv, FILE.nc, or - for CSV on standard output")
      ->type_name("FILE");
  command->add_flag("--unsigned", options->without_sign, "Without sign, for surfaces that are not closed too");
  command->add_flag("--json", options->json, "A report as JSON on stdout (data/schemas/cowgpu.distance.v1.json)");
  command->add_flag("--dry-run", options->dry_run, "Print the plan and the memory it needs, and stop");
  add_common_options(*command, common);
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
