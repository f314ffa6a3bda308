#include "host/cli/commands.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/io/png.hpp"
#include "host/mesh/topology.hpp"
#include "host/mesh/triangle_surface.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string mesh = "builtin:cow";
  std::string output;
  std::vector<std::string> views;
  int width = 1600, height = 1200;
  bool transparent = false;
  bool flat = false;
};

void run(const Options& options, const Common& common) {
  if (!options.output.ends_with(".png") || options.output.size() == 4)
    throw Error(Fault::bad_argument, fmt::format("-o {}: the name must end in .png", options.output));
  RenderScene scene;
  scene.panels.resize(std::max<std::size_t>(options.views.size(), 1));
  for (std::size_t i = 0; i < options.views.size(); ++i) scene.panels[i].view = parse_view(options.views[i]);
  scene.columns = int(scene.panels.size());
  scene.panel_width = options.width;
  scene.panel_height = options.height;
  scene.transparent = options.transparent;
  AtomicFile file(options.output); // before long work: what cannot be written should fail now

  const RawMesh mesh = load_mesh(options.mesh);
  require_valid_indices(mesh);
  const std::vector<Vec3> normals = options.flat ? std::vector<Vec3>() : vertex_normals(mesh.vertices, mesh.faces);
  double height = 0;
  for (RenderPanel& panel : scene.panels) {
    panel.surfaces.push_back({mesh.vertices, mesh.faces, normals});
    fit(panel, scene.panel_width, scene.panel_height);
    height = std::max(height, panel.height);
  }
  for (RenderPanel& panel : scene.panels) panel.height = height;

  // No Vulkan kernel draws so far: a device is opened only if it is asked for.
  const auto backend = common.device == "auto" ? make_cpu_backend(common.threads) : open_backend(common, nullptr);
  if (backend->facts().type != "cpu" && !common.quiet)
    say(fmt::format("cowgpu: pictures are made on the CPU; {} is not used\n", backend->facts().name));
  ConsoleMonitor monitor(common.style());
  const auto start = Clock::now();
  const Image image = backend->render(scene, monitor);
  const double seconds = seconds_since(start);
  monitor.clear();
  write_png(image, file);
  check_stop(monitor);
  file.commit();
  if (!common.quiet)
    say(fmt::format("cowgpu: wrote {}: {} x {} pixels, {} triangles, rendered in {:.2f} s on the CPU\n", options.output,
                    image.width, image.height, mesh.faces.size(), seconds));
}

} // namespace

void add_render(CLI::App& app, Common& common) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("render", "A picture of a mesh");
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->capture_default_str();
  command->add_option("-o,--output", options->output, "The picture, FILE.png")->type_name("FILE")->required();
  command
      ->add_option(
          "--view", options->views,
          "Where from: " + view_names() +
              ", or AZ,EL in degrees: azimuth from +z towards +x about y, elevation towards +y (side); repeated: "
              "panels side by side, all to one scale")
      ->type_name("VIEW")
      ->allow_extra_args(false);
  command->add_option("--width", options->width, "Pixels of a panel")
      ->check(CLI::Range(1, largest_picture))
      ->capture_default_str();
  command->add_option("--height", options->height, "Pixels of a panel")
      ->check(CLI::Range(1, largest_picture))
      ->capture_default_str();
  command->add_flag("--transparent", options->transparent, "No background");
  command->add_flag("--flat", options->flat, "Show the triangles: no smooth shading");
  add_common_options(*command, common);
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
