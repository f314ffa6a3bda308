#include "host/cli/commands.hpp"

#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/report/result.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace cowgpu::cli {
namespace {

// Multiply-adds of one recursion entry of a pair, counted as two flops each (bench/moments.md).
constexpr double flops_per_element = 60;

struct Options {
  std::string mesh = "builtin:cow";
  std::vector<int> lmax = {64, 128, 512};
  double cut_off = default_cut_off;
  int runs = 5;
  bool json = false;
};

struct Path {
  std::string name;
  std::unique_ptr<Backend> backend;
  double peak = 0;
  std::vector<double> seconds;
  RunReport report;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void run(const Options& options, Common& common) {
  const Body body = make_body(ClosedSurface::from(load_mesh(options.mesh)), {}, 1);
  std::vector<Path> paths;
  std::string note;
  auto opened = open_backend(common, &note);
  paths.push_back({"CPU, one thread", make_cpu_backend(1), 0, {}, {}});
  paths.push_back({"CPU, all threads", make_cpu_backend(common.threads), 0, {}, {}});
  if (opened->facts().type != "cpu") paths.push_back({"Vulkan", std::move(opened), 0, {}, {}});
  for (Path& path : paths) path.peak = path.backend->measured_peak();

  ConsoleMonitor monitor(common.style());
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  if (!options.json) {
    write_stdout(mesh_line(body.surface.mesh()) + "\n");
    if (!note.empty()) write_stdout("note: " + note + "\n");
    for (const Path& path : paths)
      write_stdout(fmt::format("{}: {}; multiply-add peak {:.1f} GFlop/s\n", path.name,
                               device_line(path.backend->facts()), path.peak * 1e-9));
    write_stdout(
        fmt::format("median of {} runs after one to warm up, paths in turn; verified before\n\n", options.runs));
    write_stdout(fmt::format("  {:>5}  {:<18} {:>10} {:>10} {:>10} {:>8}\n", "lmax", "path", "seconds", "GFlop/s",
                             "of peak", "ratio"));
  }
  for (const int lmax : options.lmax) {
    const MomentProblem problem = mass_problems(body, lmax, options.cut_off).front();
    for (Path& path : paths) {
      path.backend->moments(problem)->run(monitor); // warms up
      path.seconds.clear();
    }
    // Any of the paths will do as a measure of the others; the sample has the reference too.
    for (Path& path : paths) {
      const Accuracy accuracy = verify_moments(problem, *path.backend, Verify::sample, 1, monitor);
      if (!accuracy.passed())
        throw Error(Fault::check_failed,
                    fmt::format("{} is off by {:.1e} times what rounding explains: nothing was timed", path.name,
                                accuracy.worst()->errors.ratio));
    }
    for (int i = 0; i < options.runs; ++i)
      for (Path& path : paths) {
        path.backend->moments(problem)->run(monitor, &path.report);
        path.seconds.push_back(path.report.seconds);
      }
    const double base = median(paths[0].seconds);
    for (const Path& path : paths) {
      const double seconds = median(path.seconds), rate = path.report.elements * flops_per_element / seconds;
      rows.push_back({{"lmax", lmax},
                      {"path", path.name},
                      {"seconds", seconds},
                      {"flops_per_second", rate},
                      {"of_peak", rate / path.peak},
                      {"elements", path.report.elements},
                      {"full_elements", path.report.full_elements}});
      if (!options.json)
        write_stdout(fmt::format("  {:>5}  {:<18} {:>10.4f} {:>10.1f} {:>8.0f} % {:>8.2f}\n", lmax, path.name, seconds,
                                 rate * 1e-9, 100 * rate / path.peak, base / seconds));
    }
  }
  monitor.clear();
  if (options.json) {
    nlohmann::ordered_json devices = nlohmann::ordered_json::array();
    for (const Path& path : paths)
      devices.push_back({{"path", path.name}, {"device", device_line(path.backend->facts())}, {"peak", path.peak}});
    const nlohmann::ordered_json all = {{"schema", "cowgpu.bench.v1"},
                                        {"mesh", mesh_line(body.surface.mesh())},
                                        {"runs", options.runs},
                                        {"devices", devices},
                                        {"rows", rows}};
    write_stdout(all.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  }
}

} // namespace

void add_bench(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand("bench", "Time the CPU and the Vulkan path on a mesh, verified first");
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->capture_default_str();
  command->add_option("--lmax", options->lmax, "Degrees, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(in_range(0, largest_degree))
      ->capture_default_str();
  command->add_option("--cut-off", options->cut_off, "Cut-off, as in expand")
      ->check(in_range(0.0, 1e-3))
      ->capture_default_str();
  command->add_option("--runs", options->runs, "Timed runs of each")->check(in_range(1, 1000))->capture_default_str();
  command->add_flag("--json", options->json, "As JSON");
  add_common_options(*command, common);
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
