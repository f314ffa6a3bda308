#include "host/cli/commands.hpp"

#include "host/error.hpp"
#include "host/io/document_json.hpp"
#include "host/io/grid_file.hpp"
#include "host/requests/roundtrip.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

struct Options {
  int lmax = 0;
  int fields = 1;
  std::string grid = "gl";
  std::uint64_t seed = 1;
  int runs = 1;
  bool json = false;
  bool dry_run = false;
};

void run(const Options& options, const Common& common) {
  std::string note;
  const auto backend = open_backend(common, &note);
  if (!note.empty() && !common.quiet) say(fmt::format("cowgpu: {}\n", note));
  const RoundtripRequest request = {options.lmax, options.fields, *grid_kind_named(options.grid), options.seed,
                                    options.runs};
  ConsoleMonitor monitor(common.style());
  RoundtripResult result = options.dry_run ? plan_roundtrip(request, *backend) : roundtrip(request, *backend, monitor);
  monitor.clear();
  result.command = common.command;
  if (!note.empty()) result.notes.push_back(note);
  if (options.dry_run) return write_plan(result, write_stdout);
  if (options.json)
    write_json(document(result), write_stdout);
  else
    write_screen(result, write_stdout);
  if (result.passed()) return;
  flush_stdout();
  throw Error(Fault::check_failed,
              fmt::format("the round trip changed coefficients by {:.1e} of the largest, more than "
                          "{:.1e}: do not trust this device; try --device cpu",
                          result.error.max, result.bound));
}

} // namespace

void add_roundtrip(Command& transform, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = transform.add_subcommand(
      "roundtrip", "Random coefficients to a grid and back: how exact and how fast; exit 1 if out of bounds");
  add_degree_option(*command, options->lmax, "Largest degree, 0 to 8192");
  command->get_option("--lmax")->required();
  command->add_option("--fields", options->fields, "Fields transformed together")
      ->check(in_range(1, most_fields))
      ->capture_default_str();
  add_grid_option(*command, options->grid,
                  "gl (Gauss-Legendre), cc (Clenshaw-Curtis), dh (Driscoll-Healy, n x 2n), dh1 "
                  "(n x n), f1 (Fejer, cell-centred: n x 2n)");
  command->get_option("--grid")->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the coefficients: std::mt19937_64, uniform in [-0.5, 0.5]")
      ->check(non_negative_number())
      ->capture_default_str();
  command->add_option("--runs", options->runs, "Timed runs after one to warm up; medians are shown")
      ->check(in_range(1, most_runs))
      ->capture_default_str();
  command->add_flag("--json", options->json,
                    "As JSON on stdout (data/schemas/cowgpu.roundtrip.v1.json), times in seconds");
  command->add_flag("--dry-run", options->dry_run, "Print the grid and the memory it needs, and stop");
  add_common_options(*command, common);
  command->footer(
      "max_error is the largest error over the largest coefficient. It may be 1e-13 up to degree 64, 5e-13 at "
      "512,\n1e-12 at 1024, 3e-12 at 2048, 1e-11 at 4096; between these and beyond, a straight line in the "
      "logarithms.\nExample: cowgpu transform roundtrip --lmax 511 --fields 3");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
