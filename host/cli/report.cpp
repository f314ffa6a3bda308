#include "host/requests/report.hpp"
#include "host/cli/commands.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/mesh_source.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string result, mesh, values, output;
  std::vector<std::string> physics;
  int order = -1;
};

std::string human(std::uintmax_t bytes) {
  return bytes < 1000000 ? fmt::format("{:.0f} kB", double(bytes) / 1e3)
                         : fmt::format("{:.1f} MB", double(bytes) / 1e6);
}

void run(const Options& options, const Common& common) {
  const auto start = Clock::now();
  if (!options.output.ends_with(".html"))
    throw Error(Fault::bad_argument,
                fmt::format("-o {}: the page is HTML, and its name must end in .html", options.output));
  refuse_same_file(options.result, options.output);
  refuse_mesh_as_output(options.mesh, options.output);
  if (!options.values.empty()) refuse_same_file(options.values, options.output);
  for (const std::string& path : options.physics) refuse_same_file(path, options.output);
  const std::string page = read_page();
  AtomicFile file(options.output);

  ReportRequest request;
  request.result = options.result;
  if (!options.mesh.empty()) request.mesh = load_mesh(options.mesh);
  request.values = options.values;
  request.physics = options.physics;
  if (options.order >= 0) request.order = options.order;
  request.command = common.command;
  std::string note;
  const auto backend = open_backend(common, &note);
  if (!note.empty() && !common.quiet) say(fmt::format("cowgpu: {}\n", note));
  ConsoleMonitor monitor(common.style());
  const auto report = make_report(std::move(request), *backend, monitor);
  monitor.clear();
  if (!report->warning.empty())
    say(fmt::format("cowgpu: warning: {}: distances are to another body\n", report->warning));
  write_page(page, report->document, file);
  file.commit();
  if (!common.quiet) {
    std::error_code failed;
    const auto bytes = std::filesystem::file_size(options.output, failed);
    say(fmt::format("cowgpu: wrote {}{} in {:.1f} s\n", options.output, failed ? "" : " (" + human(bytes) + ")",
                    seconds_since(start)));
  }
}

} // namespace

void add_report(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand(
      "report", "A result as one HTML file: the body at every order, its map, spectra, tables; it needs no network");
  command->add_option("result", options->result, "FILE.json of `cowgpu expand`")
      ->type_name("RESULT")
      ->required()
      ->check(not_empty());
  command
      ->add_option("--mesh", options->mesh, "The true body, to show beside and to take distances from. " + mesh_help())
      ->type_name("MESH");
  command
      ->add_option("--values", options->values,
                   "FILE.csv of `cowgpu surface`: values at the faces or vertices of that mesh, shown on it in colours")
      ->type_name("FILE");
  command
      ->add_option("--physics", options->physics,
                   "What `cowgpu tensors --json`, `radiate --json` and the like printed; several times for several")
      ->type_name("FILE.json")
      ->allow_extra_args(false);
  command
      ->add_option("--order", options->order,
                   fmt::format("The largest order of the body ({} or the expansion's)", usual_report_order))
      ->check(in_range(0, largest_report_order))
      ->type_name("L");
  command->add_option("-o,--output", options->output, "The page, FILE.html")
      ->type_name("FILE")
      ->required()
      ->check(not_empty());
  add_common_options(*command, common);
  command->footer("Examples: cowgpu expand --of mass,stretch --lmax 64 -o cow.json\n"
                  "          cowgpu tensors --json > tensors.json\n"
                  "          cowgpu report cow.json --mesh builtin:cow --physics tensors.json -o cow.html");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
