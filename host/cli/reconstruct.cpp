#include "host/cli/commands.hpp"
#include "host/cli/order_list.hpp"
#include "host/cli/surface_outputs.hpp"
#include "host/cli/expansion_words.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/surface_file.hpp"
#include "host/report/json_parts.hpp"
#include "host/report/order_names.hpp"
#include "host/report/reconstruct_report.hpp"
#include "host/requests/surface_source.hpp"
#include "host/spectrum/expand_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu::cli {
namespace {

struct Options {
  SurfaceChoice source{"builtin:cow", "", "", -1};
  std::vector<std::string> orders;
  std::string fields = "xyz";
  int resolution = 0; // 0: default_resolution()
  std::size_t samples = 20000;
  std::string output, format;
  bool json = false;
};

// Passes on the wish to stop, and keeps quiet about the parts of an order, which are short.
class QuietMonitor final : public Monitor {
public:
  explicit QuietMonitor(const Monitor& outer) : outer_(outer) {}
  bool stopped() const override { return outer_.stopped(); }

private:
  const Monitor& outer_;
};

std::vector<int> chosen_orders(const Options& options) {
  std::vector<int> orders = parse_orders(options.orders);
  std::sort(orders.begin(), orders.end());
  return orders;
}

int resolution_of(const Options& options, int order) {
  return options.resolution > 0 ? options.resolution : default_resolution(order);
}

OutputKey order_key(int order) {
  return {std::to_string(order), fmt::format("order-{:04}", order)};
}

RebuiltOrder rebuild(const Options& options, const ReconstructReport& report, int order, SurfaceOutputs& outputs,
                     unsigned threads, Backend& backend, Monitor& monitor) {
  const auto start = Clock::now();
  RebuiltOrder result;
  result.order = order;
  result.resolution = resolution_of(options, order);
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, result.resolution);
  const TriangleSurface surface = reconstruct(*report.expansion, report.fields, order, grid, backend, monitor);
  result.vertices = surface.vertices.size();
  result.faces = surface.faces.size();
  result.measures = measure(*report.expansion, report.fields, order, backend, monitor);
  check_stop(monitor);
  if (report.body)
    result.distance = surface_distance(surface.vertices, surface.faces, report.body->surface.vertices(),
                                       report.body->surface.faces(), report.samples, threads, monitor);
  if (outputs.any()) {
    check_stop(monitor);
    result.output =
        outputs.write(order_key(order), surface,
                      {fmt::format("order {}, {}", order, order_name(order)),
                       "shape " + describe_order(*report.expansion, report.fields, order),
                       fmt::format("expansion {}, lmax {}", report.name, report.expansion->coefficients.lmax),
                       "mesh " + report.mesh, "mesh_sha256 " + report.mesh_hash},
                      {"order", double(order)});
  }
  result.seconds = seconds_since(start);
  return result;
}

void run(const Options& options, const Common& common) {
  const auto start = Clock::now();
  std::vector<int> orders = chosen_orders(options);
  const SurfaceFields fields = parse_fields(options.fields);
  const int largest = orders.empty() ? 8 : orders.back();
  check_surface_choice(options.source, orders.empty() ? 0 : largest);
  if (options.resolution > 0 && options.resolution < largest)
    throw Error(Fault::bad_argument, fmt::format("--resolution {} cannot show order {}; it must be at least the order",
                                                 options.resolution, largest));
  SurfaceOutputs outputs(options.output, options.format, orders.empty() ? 9 : orders.size(), "order");
  for (std::size_t i = 0; outputs.any() && i < (orders.empty() ? 9 : orders.size()); ++i)
    for (const std::string& input : {options.source.input, options.source.mesh})
      refuse_mesh_as_output(input, outputs.path(order_key(orders.empty() ? int(i) : orders[i])));
  outputs.open(order_key(orders.empty() ? 0 : orders.front()));

  std::string note;
  const auto backend = open_backend(common, &note);
  if (!note.empty() && !common.quiet) say(fmt::format("cowgpu: {}\n", note));
  ConsoleMonitor monitor(common.style());
  SurfaceSource source = load_surface(options.source, orders.empty() ? 0 : largest, *backend, monitor);
  if (orders.empty())
    for (int order = 0; order <= std::min(8, source.expansion.coefficients.lmax); ++order) orders.push_back(order);
  check_memory(rebuild_memory(orders.back(), resolution_of(options, orders.back()), *backend), *backend,
               "lower --order or --resolution");

  ReconstructReport report;
  report.command = common.command;
  report.created = utc_now();
  report.input = options.source.input;
  report.from_file = is_result_file(options.source.input);
  report.device = backend->facts();
  report.name = source.name;
  report.recipe = source.recipe;
  report.map_method = source.map_method;
  report.mesh = source.mesh;
  report.mesh_hash = source.mesh_hash;
  report.expansion = &source.expansion;
  report.fields = fields;
  report.body = std::move(source.body);
  report.samples = options.samples;
  report.notes = std::move(source.notes);
  if (!note.empty()) report.notes.push_back(note);
  report.source_seconds = seconds_since(start);
  QuietMonitor quiet(monitor);
  double done = 0, all = 0; // an order costs about its square, and 64 at least
  const auto cost = [](int order) { return std::pow(std::max(order, 64), 2); };
  for (const int order : orders) all += cost(order);
  try {
    for (std::size_t i = 0; i < orders.size(); ++i) {
      check_stop(monitor);
      monitor.progress("orders rebuilt", done / all);
      done += cost(orders[i]);
      report.orders.push_back(rebuild(options, report, orders[i], outputs, common.threads, *backend, quiet));
      if (!report.orders.back().output.empty() && !common.quiet) {
        monitor.clear();
        say(fmt::format("cowgpu: wrote {}\n", report.orders.back().output));
      }
    }
  } catch (const Error& error) {
    if (error.fault() != Fault::interrupted || !outputs.any() || report.orders.empty()) throw;
    throw Error(Fault::interrupted, fmt::format("interrupted: {} of {} files were written, and no part of another",
                                                report.orders.size(), orders.size()));
  }
  monitor.clear();
  report.total_seconds = seconds_since(start);
  if (options.json)
    write_json(report, write_stdout);
  else
    write_screen(report, write_stdout);
}

} // namespace

void add_reconstruct(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command =
      app.add_subcommand("reconstruct", "The body again, at any order, from the coefficients of its surface");
  command
      ->add_option("input", options->source.input,
                   "A mesh, which is mapped and expanded first, or FILE.json of `cowgpu expand --of ...`. " +
                       mesh_help())
      ->type_name("MESH|COEFFS")
      ->capture_default_str();
  command->add_option("--order", options->orders, "Orders, such as 7 or 0..7,16,32 (0..8, as far as there are any)")
      ->type_name("LIST")
      ->allow_extra_args(false);
  command
      ->add_option("--method,--of", options->source.of,
                   "Map of a mesh: stretch (default), harmonic, smooth or flow; or name of the expansion of a file "
                   "(stretch where there is one)")
      ->type_name("NAME");
  command
      ->add_option("--fields", options->fields,
                   "xyz (closer to the body at high orders), or f: distance and angles about the origin")
      ->check(one_of({"xyz", "f"}))
      ->capture_default_str();
  command
      ->add_option("--lmax", options->source.lmax,
                   fmt::format("Degree of a mesh's expansion (the largest order, {} at least)", default_lmax))
      ->check(in_range(0, largest_surface_degree))
      ->type_name("L");
  command->add_option("--mesh", options->source.mesh, "The true body beside a file, for distances")->type_name("MESH");
  command
      ->add_option("--resolution", options->resolution,
                   "Vertices lie on 2 N + 1 rings of at least as many points (N: four times the order, 64 at least, "
                   "256 at most or the order)")
      ->check(in_range(1, largest_grid_degree))
      ->type_name("N");
  command->add_option("--samples", options->samples, "Points of each surface that distances are taken from")
      ->check(in_range(std::size_t(1), std::size_t(100000000)))
      ->capture_default_str();
  command
      ->add_option("-o,--output", options->output,
                   "FILE.glb or FILE.ply, with {} for the order where there are several, or a folder, for "
                   "order-0007.glb and the like")
      ->type_name("FILE|DIR");
  command->add_option("--format", options->format, "In a folder: glb (default) or ply")->check(one_of({"glb", "ply"}));
  command->add_flag("--json", options->json, "As JSON (data/schemas/cowgpu.reconstruct.v1.json)");
  add_common_options(*command, common);
  command->footer("Examples: cowgpu reconstruct benchmark --order 0..7,32 -o 'cow-{}.glb'\n"
                  "          cowgpu expand benchmark --of stretch --lmax 512 -o cow.json\n"
                  "          cowgpu reconstruct cow.json --mesh benchmark --order 512 -o cow.ply");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
