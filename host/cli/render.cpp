#include "host/requests/render.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/drawing.hpp"
#include "host/cli/expansion_words.hpp"
#include "host/cli/order_list.hpp"

#include "host/error.hpp"
#include "host/io/png.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

struct Options {
  SurfaceChoice source{"builtin:cow", "", "", -1};
  std::vector<std::string> orders;
  std::string fields; // empty: xyz
  int resolution = 0; // 0: default_resolution()
  std::string output;
  std::vector<std::string> views;
  int columns = 0; // 0: one row up to four panels, then as many rows as columns
  int width = 1600, height = 1200;
  bool transparent = false;
  bool flat = false;
};

RenderRequest request_of(const Options& options, const Common& common) {
  RenderRequest request;
  request.source = options.source;
  if (!options.views.empty()) request.views.clear();
  for (const std::string& view : options.views) request.views.push_back(parse_view(view));
  for (const int order : parse_orders(options.orders, "mesh"))
    request.orders.push_back(order == whole_mesh ? std::nullopt : std::optional(order));
  if (!request.rebuilds() && (!options.source.of.empty() || !options.fields.empty() || options.source.lmax >= 0 ||
                              !options.source.mesh.empty() || options.resolution > 0))
    throw Error(Fault::bad_argument, "--of, --fields, --lmax, --mesh and --resolution are about bodies rebuilt at an "
                                     "order; add --order, or leave them out to see the mesh itself");
  if (!options.fields.empty()) request.fields = parse_fields(options.fields);
  request.resolution = options.resolution;
  request.flat = options.flat;
  request.panels = {options.width, options.height, options.columns, options.transparent};
  request.threads = common.threads;
  return request;
}

void run(const Options& options, const Common& common) {
  if (!options.output.ends_with(".png") || options.output.size() == 4)
    throw Error(Fault::bad_argument, fmt::format("-o {}: the name must end in .png", options.output));
  const RenderRequest request = request_of(options, common);
  check_render(request);
  for (const std::string& input : {options.source.input, options.source.mesh})
    refuse_mesh_as_output(input, options.output);
  AtomicFile file(options.output); // before long work: what cannot be written should fail now

  auto backend = open_backend(common, nullptr);
  if (auto cpu = faster_drawing(*backend, common)) backend = std::move(cpu);
  ConsoleMonitor monitor(common.style());
  const RenderResult result = render(request, *backend, monitor);
  monitor.clear();
  write_png(result.image, file);
  check_stop(monitor);
  file.commit();
  for (const std::string& note : result.notes)
    if (!common.quiet) say(fmt::format("cowgpu: note: {}\n", note));
  if (!common.quiet)
    say(fmt::format("cowgpu: wrote {}: {} x {} pixels, {} triangles, rendered in {:.2f} s on {}\n", options.output,
                    result.image.width, result.image.height, result.triangles, result.seconds,
                    backend->facts().type == "cpu" ? "the CPU" : backend->facts().name));
}

} // namespace

void add_render(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand("render", "A picture of a mesh, or of its body rebuilt at some orders");
  command
      ->add_option("input", options->source.input,
                   "A mesh, or FILE.json of `cowgpu expand --of ...`, whose body is rebuilt. " + mesh_help())
      ->type_name("MESH|COEFFS")
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "The picture, FILE.png")->type_name("FILE")->required();
  command
      ->add_option(
          "--view", options->views,
          "Where from: " + view_names() +
              ", or AZ,EL in degrees: azimuth from +z towards +x about y, elevation towards +y (side); repeated: "
              "panels side by side, all to one scale")
      ->type_name("VIEW")
      ->allow_extra_args(false);
  command
      ->add_option("--order", options->orders,
                   "Rebuild the body at these orders, such as 7 or 0..7,mesh, where mesh is the body itself: a panel "
                   "each, all to one scale (of a file: its lmax)")
      ->type_name("LIST")
      ->allow_extra_args(false);
  command
      ->add_option("--of,--method", options->source.of,
                   "With --order: the map (stretch, harmonic, smooth or flow), or a file's expansion by name (stretch)")
      ->type_name("NAME");
  command->add_option("--fields", options->fields, "With --order: xyz (default), or f: distance and angles")
      ->check(one_of({"xyz", "f"}));
  command
      ->add_option(
          "--lmax", options->source.lmax,
          fmt::format("With --order: degree of a mesh's expansion (the largest order, {} at least)", default_lmax))
      ->check(in_range(0, largest_surface_degree))
      ->type_name("L");
  command->add_option("--mesh", options->source.mesh, "The true body beside a file, for --order mesh")
      ->type_name("MESH");
  command
      ->add_option("--resolution", options->resolution,
                   "Vertices of rebuilt bodies lie on 2 N + 1 rings (N: four times the order, 64 at least, 256 at "
                   "most or the order)")
      ->check(in_range(1, largest_grid_degree))
      ->type_name("N");
  command->add_option("--columns", options->columns, "Panels side by side (up to 4, then a square)")
      ->check(in_range(1, largest_picture))
      ->type_name("N");
  command->add_option("--width", options->width, "Pixels of a panel")
      ->check(in_range(1, largest_picture))
      ->capture_default_str();
  command->add_option("--height", options->height, "Pixels of a panel")
      ->check(in_range(1, largest_picture))
      ->capture_default_str();
  command->add_flag("--transparent", options->transparent, "No background");
  command->add_flag("--flat", options->flat, "Show the triangles: no smooth shading");
  add_common_options(*command, common);
  command->footer("Example: cowgpu render benchmark --order 0..7,mesh --width 400 --height 300 -o cow.png");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
