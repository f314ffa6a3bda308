#include "host/requests/inspect.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/mend_options.hpp"
#include "host/error.hpp"
#include "host/io/document_json.hpp"
#include "host/io/off.hpp"
#include "host/io/ply.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string mesh = "builtin:cow", output;
  Mending mending;
  bool json = false;
};

bool is_ply(const std::string& output) {
  const std::string suffix = std::filesystem::path(output).extension();
  if (suffix == ".ply" || suffix == ".off") return suffix == ".ply";
  throw Error(Fault::bad_argument, fmt::format("-o {}: the mesh is written as FILE.ply or FILE.off", output));
}

void write_mesh(const RawMesh& mesh, const std::string& output, AtomicFile& file) {
  const TriangleSurface surface{mesh.name, mesh.vertices, mesh.faces, {}, {}};
  if (is_ply(output))
    write_ply(surface, mesh.notes, file);
  else
    write_off(surface, mesh.notes, file);
  file.commit();
}

void run(const Options& options, const Common& common) {
  std::unique_ptr<AtomicFile> file;
  if (!options.output.empty()) {
    is_ply(options.output);
    refuse_mesh_as_output(options.mesh, options.output);
    file = std::make_unique<AtomicFile>(options.output);
  }
  ConsoleMonitor monitor(common.style());
  RawMesh mesh = load_mended(options.mesh, options.mending, monitor);
  const Inspection found = inspect(std::move(mesh), monitor, common.threads);
  monitor.clear();
  if (file) {
    write_mesh(found.mesh, options.output, *file);
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  }
  if (options.json)
    write_json(document(found, options.output), write_stdout);
  else
    write_inspection(found, write_stdout);
}

} // namespace

void add_inspect(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand(
      "inspect", "Facts about a mesh: topology, self-intersections, size, what it is fit for; and mends it on demand");
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->capture_default_str();
  add_mend_options(*command, options->mending);
  command
      ->add_option("-o,--output", options->output,
                   "Write the mesh, mended as asked for: FILE.ply (binary) or FILE.off (text), doubles that read back "
                   "bit for bit")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "As JSON (data/schemas/cowgpu.inspect.v1.json)");
  add_run_options(*command, common);
  command->footer("Examples: cowgpu inspect benchmark; cowgpu inspect scan.stl --weld 1e-6 --orient -o mended.ply");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
