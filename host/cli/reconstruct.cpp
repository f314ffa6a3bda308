#include "host/cli/commands.hpp"
#include "host/cli/expansion_words.hpp"
#include "host/cli/order_list.hpp"
#include "host/cli/surface_outputs.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/document_json.hpp"
#include "host/requests/reconstruct.hpp"

#include <fmt/format.h>

#include <algorithm>

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

ReconstructRequest request_of(const Options& options, const Common& common) {
  ReconstructRequest request;
  request.source = options.source;
  request.orders = parse_orders(options.orders);
  std::sort(request.orders.begin(), request.orders.end());
  request.fields = parse_fields(options.fields);
  request.resolution = options.resolution;
  request.samples = options.samples;
  request.threads = common.threads;
  return request;
}

OutputKey order_key(int order) {
  return {std::to_string(order), fmt::format("order-{:04}", order)};
}

void run(const Options& options, const Common& common) {
  const auto start = Clock::now();
  const ReconstructRequest request = request_of(options, common);
  check_reconstruct(request);
  std::vector<int> orders = request.orders; // or as many as there may be
  for (int order = 0; request.orders.empty() && order <= 8; ++order) orders.push_back(order);
  SurfaceOutputs outputs(options.output, options.format, orders.size(), "order");
  for (const int order : orders)
    for (const std::string& input : {options.source.input, options.source.mesh})
      if (outputs.any()) refuse_mesh_as_output(input, outputs.path(order_key(order)));
  outputs.open(order_key(orders.front()));

  std::string note;
  const auto backend = open_backend(common, &note);
  if (!note.empty() && !common.quiet) say(fmt::format("cowgpu: {}\n", note));
  ConsoleMonitor monitor(common.style());
  std::size_t written = 0;
  const auto write = [&](const ReconstructReport& report, int order, const TriangleSurface& body) -> std::string {
    if (!outputs.any()) return "";
    check_stop(monitor);
    const std::string path =
        outputs.write(order_key(order), body, order_facts(report, order), {"order", double(order)});
    ++written;
    monitor.clear();
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", path));
    return path;
  };
  ReconstructReport report;
  try {
    report = reconstruct(request, *backend, monitor, write);
  } catch (const Error& error) {
    if (error.fault() != Fault::interrupted || written == 0) throw;
    throw Error(Fault::interrupted, fmt::format("interrupted: {} of {} files were written, and no part of another",
                                                written, orders.size()));
  }
  monitor.clear();
  report.command = common.command;
  if (!note.empty()) report.notes.push_back(note);
  report.total_seconds = seconds_since(start);
  if (options.json)
    write_json(document(report), write_stdout);
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
      ->check(in_range(std::size_t(1), most_samples))
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
