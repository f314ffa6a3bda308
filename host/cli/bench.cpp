#include "host/requests/bench.hpp"
#include "host/cli/commands.hpp"

#include "host/io/document_json.hpp"
#include "host/io/mesh_source.hpp"

namespace cowgpu::cli {
namespace {

struct Options {
  std::string mesh = "builtin:cow";
  BenchRequest request;
  bool json = false;
};

void run(const Options& options, const Common& common) {
  BenchRequest request = options.request;
  request.mesh = load_mesh(options.mesh);
  request.threads = common.threads;
  std::string note;
  const auto backend = open_backend(common, &note);
  ConsoleMonitor monitor(common.style());
  BenchResult result = bench_moments(std::move(request), backend.get(), monitor);
  if (!note.empty()) result.notes.push_back(note);
  monitor.clear();
  if (options.json)
    write_json(document(result), write_stdout);
  else
    write_bench(result, write_stdout);
}

} // namespace

void add_bench(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand("bench", "Time the CPU and the Vulkan path on a mesh, verified first");
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->capture_default_str();
  command->add_option("--lmax", options->request.lmax, "Degrees, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(in_range(0, largest_degree))
      ->capture_default_str();
  command->add_option("--cut-off", options->request.cut_off, "Cut-off, as in expand")
      ->check(in_range(0.0, largest_cut_off))
      ->capture_default_str();
  command->add_option("--runs", options->request.runs, "Timed runs of each")
      ->check(in_range(1, most_runs))
      ->capture_default_str();
  command->add_flag("--json", options->json, "As JSON");
  add_common_options(*command, common);
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
