#include "host/cli/commands.hpp"

#include "host/error.hpp"
#include "host/report/result.hpp"
#include "host/requests/load_body.hpp"
#include "host/requests/validate.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string mesh = "builtin:cow@1", origin = "com";
  int lmax = 64;
  double cut_off = default_cut_off;
};

void run(const Options& options, Common& common) {
  std::vector<std::string> notes;
  BodyRequest request;
  request.mesh = options.mesh;
  request.origin = parse_origin(options.origin);
  ConsoleMonitor monitor(common.style());
  const Body body = load_body(request, notes, monitor);
  std::string note;
  const auto backend = open_backend(common, &note);
  const bool gpu = backend->facts().type != "cpu";
  const Validation validation =
      validate_moments(body, options.lmax, options.cut_off, gpu ? backend.get() : nullptr, common.threads, monitor);
  monitor.clear();

  write_stdout(mesh_line(body.surface.mesh()) + "\n");
  if (!note.empty()) notes.push_back(note);
  for (const std::string& n : notes) write_stdout("note: " + n + "\n");
  if (gpu) write_stdout("device: " + device_line(backend->facts()) + "\n");
  write_stdout("device: " + device_line(make_cpu_backend(common.threads)->facts()) + "\n");
  write_stdout(fmt::format("degrees 0 to {} about ({:.9g}, {:.9g}, {:.9g}) ({}), all triangles\n", options.lmax,
                           body.origin.x(), body.origin.y(), body.origin.z(), body.origin_kind));
  for (const std::string& sentence : sentences(validation.estimate)) write_stdout("estimate: " + sentence + "\n");
  write_stdout("\nerror: the largest of a degree over its norm, of degrees known to half of it; over estimate: the "
               "largest\nerror over what rounding explains, at this degree\n\n");
  std::size_t width = 0;
  for (const Check& check : validation.checks) width = std::max(width, check.what.size());
  write_stdout(fmt::format("  {:<{}}  {:>8}  {:>13}  {:>6}  {:>5}\n", "check", width, "error", "over estimate",
                           "degree", "bound"));
  std::size_t failed = 0;
  for (const Check& check : validation.checks) {
    write_stdout(fmt::format("  {:<{}}  {:>8}  {:>13.2g}  {:>6}  {:>5.2g}  {}\n", check.what, width,
                             check.relative < 0 ? "" : fmt::format("{:.1e}", check.relative), check.value,
                             check.degree < 0 ? "" : std::to_string(check.degree), check.bound,
                             check.passed ? "passed" : "FAILED"));
    failed += !check.passed;
  }
  if (failed) {
    flush_stdout();
    throw Error(Fault::check_failed,
                fmt::format("{} of {} checks are out of bounds", failed, validation.checks.size()));
  }
}

} // namespace

void add_validate(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand(
      "validate", "Compute by every path and by a slow reference, and compare; exit 1 if anything is out of bounds");
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->capture_default_str();
  command->add_option("--origin", options->origin, "Origin, as in expand: com (centre of mass), mesh, or X,Y,Z")
      ->capture_default_str();
  command->add_option("--lmax", options->lmax, "Largest degree, 0 to 4096")
      ->check(in_range(0, largest_degree))
      ->capture_default_str();
  command->add_option("--cut-off", options->cut_off, "Cut-off, as in expand")
      ->check(in_range(0.0, largest_cut_off))
      ->capture_default_str();
  add_common_options(*command, common);
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
