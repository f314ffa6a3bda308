#include "host/cli/commands.hpp"
#include "host/cli/mend_options.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/distance_file.hpp"
#include "host/io/point_file.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/winding_notes.hpp"
#include "host/report/json_parts.hpp"
#include "host/report/result.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cowgpu::cli {
namespace {

constexpr double enlargement = 1.1; // factor of the box that --grid fills

struct Options {
  std::string mesh = "builtin:cow", points, output;
  Mending mending;
  std::size_t grid = 0;
  bool without_sign = false, json = false, dry_run = false;
};

struct Summary {
  std::size_t inside = 0, outside = 0, on_surface = 0, overlapped = 0;
  double smallest = std::numeric_limits<double>::infinity(), largest = -smallest;
};

Summary summary_of(const ClosestPoints& points) {
  Summary s;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double d = points.distance[i];
    s.inside += d < 0;
    s.outside += d > 0;
    s.on_surface += d == 0;
    s.overlapped += !points.winding.empty() && points.winding[i] != 0 && points.winding[i] != 1;
    s.smallest = std::min(s.smallest, d);
    s.largest = std::max(s.largest, d);
  }
  return s;
}

struct Run {
  RawMesh mesh;
  std::vector<Vec3> queries;
  std::optional<PointLattice> lattice;
  std::vector<std::string> notes;
  DeviceFacts device;
  ClosestReport report;
  double read_seconds = 0, setup_seconds = 0, write_seconds = 0;
};

std::string lattice_text(const PointLattice& lattice) {
  return fmt::format("{} x {} x {} points {:.6g} apart, the bounding box enlarged by {}", lattice.counts[0],
                     lattice.counts[1], lattice.counts[2], lattice.spacing, enlargement);
}

void write_json_report(const Options& options, const Common& common, const Run& run, const Summary& summary) {
  nlohmann::ordered_json all = {{"schema", "cowgpu.distance.v1"},
                                {"program", program_json()},
                                {"command", common.command},
                                {"created", utc_now()},
                                {"mesh",
                                 {{"name", run.mesh.name},
                                  {"sha256", run.mesh.sha256},
                                  {"vertices", run.mesh.vertices.size()},
                                  {"faces", run.mesh.faces.size()}}},
                                {"points", run.queries.size()},
                                {"signed", !options.without_sign},
                                {"outside", summary.outside},
                                {"on_surface", summary.on_surface},
                                {"smallest", summary.smallest},
                                {"largest", summary.largest},
                                {"device", device_json(run.device)},
                                {"notes", run.notes},
                                {"timings",
                                 {{"read", run.read_seconds},
                                  {"setup", run.setup_seconds},
                                  {"distance", run.report.seconds},
                                  {"write", run.write_seconds}}}};
  if (!options.without_sign) {
    all["inside"] = summary.inside;
    all["overlapped"] = summary.overlapped;
  }
  if (!options.points.empty()) all["input"] = options.points;
  if (!options.output.empty()) all["output"] = options.output;
  if (run.lattice) {
    const PointLattice& g = *run.lattice;
    all["grid"] = {{"counts", g.counts},
                   {"first", {g.first.x(), g.first.y(), g.first.z()}},
                   {"spacing", g.spacing},
                   {"enlargement", enlargement}};
  }
  write_stdout(json_text(all) + "\n");
}

void write_text_report(const Options& options, const Run& run, const Summary& summary) {
  write_stdout(mesh_line(run.mesh) + "\n");
  for (const std::string& note : run.notes) write_stdout("note: " + note + "\n");
  if (run.lattice) write_stdout("grid: " + lattice_text(*run.lattice) + "\n");
  const double rate = double(run.queries.size()) / run.report.seconds;
  write_stdout(fmt::format("computed: {} distances of {} points in {:.3f} s, {:.3g} a second\n",
                           options.without_sign ? "unsigned" : "signed", run.queries.size(), run.report.seconds, rate));
  write_stdout(fmt::format("distances: {:.17g} to {:.17g}\n", summary.smallest, summary.largest));
  if (!options.without_sign)
    write_stdout(fmt::format(
        "points: {} inside, {} outside, {} on the surface, {} where the winding number is neither 0 nor 1\n",
        summary.inside, summary.outside, summary.on_surface, summary.overlapped));
  write_stdout("device: " + device_line(run.device) + "\n");
  write_stdout(fmt::format("time: read {:.3f} s, set-up {:.3f} s, distances {:.3f} s, write {:.3f} s\n",
                           run.read_seconds, run.setup_seconds, run.report.seconds, run.write_seconds));
}

// Queries, result, and a file's image: netCDF or text.
MemoryNeed memory_need(const DistanceField& field, std::size_t count) {
  MemoryNeed need = field.memory(count);
  need.host += 24 * count + 152 * count;
  return need;
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
  Run run;
  run.mesh = load_mended(options.mesh, options.mending);
  ConsoleMonitor monitor(common.style());
  if (options.without_sign) {
    check_distance_surface(run.mesh.vertices, run.mesh.faces);
    run.notes = run.mesh.notes;
  } else {
    const ClosedSurface surface = ClosedSurface::from(std::move(run.mesh));
    run.notes = body_notes(surface, monitor, common.threads);
    run.mesh = surface.mesh();
  }
  std::size_t count = 0;
  if (options.grid) {
    const Box box = bounding_box(run.mesh.vertices, run.mesh.faces);
    run.lattice = lattice_about(box.min, box.max, enlargement, options.grid);
    count = run.lattice->size();
  } else {
    run.queries = read_points(options.points);
    count = run.queries.size();
  }
  run.read_seconds = seconds_since(start);

  start = Clock::now();
  std::string note;
  const auto backend = open_backend(common, &note);
  if (!note.empty()) run.notes.push_back(note);
  run.device = backend->facts();
  if (!common.quiet && !note.empty()) say(fmt::format("cowgpu: {}\n", note));
  const auto field = backend->distance_field(run.mesh.vertices, run.mesh.faces);
  const MemoryNeed need = memory_need(*field, count);
  check_memory(need, *backend, options.grid ? "lower --grid" : "pass fewer points at once");
  if (options.dry_run) {
    write_stdout(fmt::format("plan: {} distances of {} points from {} triangles\n",
                             options.without_sign ? "unsigned" : "signed", count, run.mesh.faces.size()));
    if (run.lattice) write_stdout("grid: " + lattice_text(*run.lattice) + "\n");
    write_stdout("device: " + device_line(run.device) + "\n");
    write_stdout(fmt::format("memory: at most {} MiB on the host, files and all, and {} MiB on the device\n",
                             (need.host >> 20) + 1, (need.device + (1 << 20) - 1) >> 20));
    return;
  }
  if (run.lattice) run.queries = run.lattice->points();
  field->prepare();
  run.setup_seconds = seconds_since(start);
  const ClosestPoints points = field->closest(run.queries, {!options.without_sign}, monitor, &run.report);
  monitor.clear();

  start = Clock::now();
  const DistanceTable table{run.mesh.name, run.mesh.sha256, run.queries, points, run.lattice};
  if (to_stdout) {
    write_distances_csv(table, write_stdout);
    return;
  }
  if (file) {
    if (format == FileFormat::csv)
      write_distances_csv(table, [&](std::string_view text) {
        check_stop(monitor);
        file->write(text);
      });
    else
      write_distances(table, format, *file);
    check_stop(monitor);
    file->commit();
    run.write_seconds = seconds_since(start);
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  }
  if (options.json)
    write_json_report(options, common, run, summary_of(points));
  else
    write_text_report(options, run, summary_of(points));
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
      ->check(in_range(std::size_t(2), std::size_t(4096)))
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
