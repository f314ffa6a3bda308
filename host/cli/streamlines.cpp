#include "host/requests/streamlines.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/mend_options.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/atomic_file.hpp"
#include "host/io/document_json.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string mesh = "builtin:cow", plane = "yz", origin = "0,0,0", output;
  Mending mending;
  std::size_t count = StreamlinesRequest{}.count;
  std::optional<double> time, space, within;
  double tolerance = StreamlinesRequest{}.tolerance;
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

void run(const Options& options, const Common& common) {
  const Layout layout = layout_of(options.output);
  const bool to_stdout = options.output == "-";
  if (to_stdout && options.json)
    throw Error(Fault::bad_argument, "--json and -o - both write to the standard output; name a file");
  StreamlinesRequest request;
  request.plane = parse_plane(options.plane);
  const auto origin = parse_point(options.origin);
  if (!origin)
    throw Error(Fault::bad_argument,
                fmt::format("--origin {}: it must be three numbers X,Y,Z in mesh coordinates", options.origin));
  request.origin = *origin;
  request.time = options.time;
  request.count = options.count;
  request.space = options.space;
  request.within = options.within;
  request.tolerance = options.tolerance;
  request.threads = common.threads;
  std::unique_ptr<AtomicFile> file;
  if (!to_stdout) refuse_mesh_as_output(options.mesh, options.output);
  if (layout != Layout::none && !to_stdout) file = std::make_unique<AtomicFile>(options.output);

  const auto start = Clock::now();
  ConsoleMonitor monitor(common.style());
  request.mesh = load_mended(options.mesh, options.mending, monitor);
  const double load_seconds = seconds_since(start);
  std::string note;
  const auto backend = open_backend(common, &note);
  StreamlinesResult result = find_streamlines(std::move(request), *backend, monitor);
  monitor.clear();
  if (!note.empty()) result.notes.push_back(note);
  result.read_seconds += load_seconds;

  if (to_stdout) {
    write_streamlines_csv(result.table, write_stdout);
    return;
  }
  if (file) {
    if (layout == Layout::json)
      write_json(document(result, common.command), [&](std::string_view text) { file->write(text); });
    else
      write_streamlines_csv(result.table, [&](std::string_view text) { file->write(text); });
    check_stop(monitor);
    file->commit();
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  }
  if (options.json)
    write_json(document(result, common.command), write_stdout);
  else
    write_streamlines(result, options.plane, write_stdout);
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
                    ->check(in_range(std::size_t(1), most_streamlines))
                    ->type_name("N")
                    ->capture_default_str();
  auto* spacing = command->add_option("--spacing", options->space, "How far apart the lines start, instead of --count")
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
      ->check(in_range(least_tolerance, largest_tolerance))
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "Lines as FILE.csv or FILE.json, or - for CSV on standard output")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "The lines as JSON on stdout (data/schemas/cowgpu.streamlines.v1.json)");
  add_common_options(*command, common);
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
