#include "host/cli/commands.hpp"
#include "host/cli/mend_options.hpp"
#include "host/requests/expand_flow.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/atomic_file.hpp"
#include "host/io/streamline_file.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/winding_notes.hpp"
#include "host/report/flow_result.hpp"
#include "host/report/json_parts.hpp"
#include "host/report/result.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace cowgpu::cli {
namespace {

constexpr std::size_t default_count = 200, most_lines = 1'000'000;

struct Options {
  std::string mesh = "builtin:cow", plane = "yz", origin = "0,0,0", output;
  Mending mending;
  std::size_t count = default_count;
  double time = 0, spacing = 0, within = -1, tolerance = FlowOptions{}.tolerance;
  bool json = false;
};

enum class Layout { none, csv, json };

Layout layout_of(const std::string& output) {
  if (output.empty()) return Layout::none;
  const std::string suffix = std::filesystem::path(output).extension();
  if (output == "-" || suffix == ".csv") return Layout::csv;
  if (suffix == ".json") return Layout::json;
  throw Error(Fault::bad_argument,
              fmt::format("-o {}: streamlines go to FILE.csv, FILE.json, or - for CSV on standard output", output));
}

StreamlineStarts starts_of(const Options& options, const RawMesh& mesh, const StreamlineTable& table) {
  if (options.within >= 0) {
    StreamlineStarts starts = starts_near(table.plane, options.within, mesh.vertices, mesh.faces);
    if (starts.places.empty())
      throw Error(
          Fault::mesh_empty,
          fmt::format("no vertex of {} lies within {} of the plane {}: widen --vertices, or start on the cut with "
                      "--count",
                      mesh.name, options.within, options.plane));
    return starts;
  }
  double length = 0;
  for (const CutLoop& loop : table.cut) length += loop.length;
  const double count =
      options.spacing > 0 ? std::max(1.0, std::round(length / options.spacing)) : double(options.count);
  if (count > double(most_lines))
    throw Error(Fault::bad_argument,
                fmt::format("--spacing {} asks for {:.3g} lines along a cut of length {:.6g}: at most {} "
                            "are drawn",
                            options.spacing, count, length, most_lines));
  return starts_along(table.cut, std::size_t(count), mesh.vertices, mesh.faces);
}

void run(const Options& options, const Common& common) {
  const Layout layout = layout_of(options.output);
  const bool to_stdout = options.output == "-";
  if (to_stdout && options.json)
    throw Error(Fault::bad_argument, "--json and -o - both write to the standard output; name a file");
  StreamlineTable table;
  table.plane = parse_plane(options.plane);
  const auto origin = parse_point(options.origin);
  if (!origin)
    throw Error(Fault::bad_argument,
                fmt::format("--origin {}: it must be three numbers X,Y,Z in mesh coordinates", options.origin));
  table.origin = *origin;
  std::unique_ptr<AtomicFile> file;
  if (!to_stdout) refuse_mesh_as_output(options.mesh, options.output);
  if (layout != Layout::none && !to_stdout) file = std::make_unique<AtomicFile>(options.output);

  auto start = Clock::now();
  const ClosedSurface surface = ClosedSurface::from(load_mended(options.mesh, options.mending));
  const RawMesh& mesh = surface.mesh();
  ConsoleMonitor monitor(common.style());
  std::vector<std::string> notes = body_notes(surface, monitor, common.threads);
  table.mesh = mesh.name;
  table.sha256 = mesh.sha256;
  const Box box = bounding_box(surface);
  if (options.time > 0) check_flow_time(options.time, box);
  table.time = options.time > 0 ? options.time : (box.max - box.min).norm();
  table.tolerance = options.tolerance;
  table.cut = cut_by_plane(mesh.vertices, mesh.faces, table.plane);
  if (table.cut.empty() && options.within < 0)
    throw Error(Fault::mesh_empty,
                fmt::format("the plane {} misses {}, whose box goes from ({:.6g}, {:.6g}, {:.6g}) to "
                            "({:.6g}, {:.6g}, {:.6g}): choose another --plane",
                            options.plane, mesh.name, box.min.x(), box.min.y(), box.min.z(), box.max.x(), box.max.y(),
                            box.max.z()));
  table.starts = starts_of(options, mesh, table);
  const double read_seconds = seconds_since(start);

  start = Clock::now();
  std::string note;
  const auto backend = open_backend(common, &note);
  if (!note.empty()) notes.push_back(note);
  const auto flow = backend->distance_flow(mesh.vertices, mesh.faces);
  FlowOptions how;
  how.time = table.time;
  how.tolerance = options.tolerance;
  table.found = streamlines(mesh.vertices, mesh.faces, table.starts, table.origin, how, *flow, *backend, monitor);
  monitor.clear();
  const double flow_seconds = seconds_since(start);

  if (to_stdout) {
    write_streamlines_csv(table, write_stdout);
    return;
  }
  const auto document = [&] {
    nlohmann::ordered_json all = {{"schema", "cowgpu.streamlines.v1"},
                                  {"program", program_json()},
                                  {"command", common.command},
                                  {"created", utc_now()}};
    all.update(streamlines_json(table));
    all["device"] = device_json(backend->facts());
    all["notes"] = notes;
    all["timings"] = {{"read", read_seconds}, {"flow", flow_seconds}};
    return json_text(all) + "\n";
  };
  if (file) {
    if (layout == Layout::json)
      file->write(document());
    else
      write_streamlines_csv(table, [&](std::string_view text) { file->write(text); });
    check_stop(monitor);
    file->commit();
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  }
  if (options.json) {
    write_stdout(document());
    return;
  }
  write_stdout(mesh_line(mesh) + "\n");
  for (const std::string& sentence : notes) write_stdout("note: " + sentence + "\n");
  double length = 0;
  for (const CutLoop& loop : table.cut) length += loop.length;
  write_stdout(fmt::format("cut: plane {}, {} closed line{} of length {:.9g}\n", options.plane, table.cut.size(),
                           table.cut.size() == 1 ? "" : "s", length));
  write_stdout(fmt::format("streamlines: to t = {:.6g}; {}\n", table.time, flow_points_text(table.found.report)));
  write_stdout(fmt::format("time: read {:.3f} s, flow {:.3f} s\n", read_seconds, flow_seconds));
}

} // namespace

void add_streamlines(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand(
      "streamlines", "Streamlines of the distance's flow off the cut of a surface with a plane, as data for a figure");
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->required();
  add_mend_options(*command, options->mending);
  command
      ->add_option("--plane", options->plane,
                   "yz, xy or xz through the mesh's origin, or NX,NY,NZ,D: the points with NX x + NY y + NZ z = D")
      ->type_name("PLANE")
      ->capture_default_str();
  command
      ->add_option("--time", options->time, "Time, which is length, to flow for (default: the bounding box's diagonal)")
      ->check(positive_number())
      ->type_name("T");
  auto* count = command->add_option("--count", options->count, "Lines, evenly spaced along the cut")
                    ->check(in_range(std::size_t(1), most_lines))
                    ->type_name("N")
                    ->capture_default_str();
  auto* spacing =
      command->add_option("--spacing", options->spacing, "How far apart the lines start, instead of --count")
          ->check(positive_number())
          ->type_name("S")
          ->excludes(count);
  command
      ->add_option("--vertices", options->within,
                   "Start at the mesh's vertices, not on the cut: at those no farther than W from the plane")
      ->check(non_negative_number())
      ->type_name("W")
      ->excludes(count)
      ->excludes(spacing);
  command
      ->add_option("--origin", options->origin, "Where the directions of the ends are seen from, in mesh coordinates")
      ->type_name("X,Y,Z")
      ->capture_default_str();
  command->add_option("--tolerance", options->tolerance, "Error allowed per time on the medial axis")
      ->check(in_range(1e-12, 1e-2))
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "Lines as FILE.csv or FILE.json, or - for CSV on standard output")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "The lines as JSON on stdout (data/schemas/cowgpu.streamlines.v1.json)");
  add_common_options(*command, common);
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
