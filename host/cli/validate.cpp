#include "host/cli/commands.hpp"

#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/report/result.hpp"
#include "host/spectrum/validate.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string mesh = "builtin:cow@1";
  int lmax = 64;
  double cut_off = default_cut_off;
};

void run(const Options& options, Common& common) {
  const Body body = make_body(ClosedSurface::from(load_mesh(options.mesh)), {}, 1);
  std::string note;
  const auto backend = open_backend(common, &note);
  const bool gpu = backend->facts().type != "cpu";
  ConsoleMonitor monitor(common.style());
  const auto checks =
      validate_moments(body, options.lmax, options.cut_off, gpu ? backend.get() : nullptr, common.threads, monitor);
  monitor.clear();

  write_stdout(mesh_line(body.surface.mesh()) + "\n");
  if (!note.empty()) write_stdout("note: " + note + "\n");
  if (gpu) write_stdout("device: " + device_line(backend->facts()) + "\n");
  write_stdout("device: " + device_line(make_cpu_backend(common.threads)->facts()) + "\n");
  write_stdout(
      fmt::format("degrees 0 to {}, all triangles; errors of a degree over its norm, or over its bound where the "
                  "norm is below 1e-3 of that\n\n",
                  options.lmax));
  std::size_t width = 0;
  for (const Check& check : checks) width = std::max(width, check.what.size());
  write_stdout(fmt::format("  {:<{}}  {:>8}  {:>6}  {:>8}\n", "check", width, "found", "degree", "bound"));
  std::size_t failed = 0;
  for (const Check& check : checks) {
    write_stdout(fmt::format("  {:<{}}  {:>8.1e}  {:>6}  {:>8.1e}  {}\n", check.what, width, check.value,
                             check.degree < 0 ? "" : std::to_string(check.degree), check.bound,
                             check.passed ? "passed" : "FAILED"));
    failed += !check.passed;
  }
  if (failed) {
    flush_stdout();
    throw Error(Fault::check_failed, fmt::format("{} of {} checks are out of bounds", failed, checks.size()));
  }
}

} // namespace

void add_validate(CLI::App& app, Common& common) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "validate", "Compute by every path and by a slow reference, and compare; exit 1 if anything is out of bounds");
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->capture_default_str();
  command->add_option("--lmax", options->lmax, "Largest degree, 0 to 4096")
      ->check(in_range(0, largest_degree))
      ->capture_default_str();
  command->add_option("--cut-off", options->cut_off, "As in expand")->check(in_range(0.0, 1e-3))->capture_default_str();
  add_common_options(*command, common);
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
