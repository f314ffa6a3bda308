#include "host/cli/commands.hpp"

#include "host/error.hpp"
#include "host/io/grid_file.hpp"
#include "host/report/json_parts.hpp"
#include "host/report/result.hpp"
#include "host/requests/roundtrip.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

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

std::uint64_t peak_resident() {
  struct rusage usage {};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

nlohmann::ordered_json stage_json(const TransformReport& report) {
  nlohmann::ordered_json kernels = nlohmann::ordered_json::array();
  for (const KernelTime& k : report.kernels)
    kernels.push_back({{"kernel", k.kernel}, {"dispatches", k.dispatches}, {"seconds", k.seconds}});
  return {{"legendre_seconds", report.legendre_seconds},
          {"fourier_seconds", report.fourier_seconds},
          {"legendre_flops", report.legendre_flops},
          {"fourier_flops", report.fourier_flops},
          {"kernels", kernels}};
}

void write_json(const Options& options, const Common& common, const RoundtripResult& o, const std::string& note) {
  nlohmann::ordered_json notes = nlohmann::ordered_json::array();
  if (!note.empty()) notes.push_back(note);
  const nlohmann::ordered_json all = {
      {"schema", "cowgpu.roundtrip.v1"},
      {"program", program_json()},
      {"command", common.command},
      {"created", utc_now()},
      {"device", device_json(o.device)},
      {"notes", notes},
      {"grid", {{"kind", name(o.grid.kind)}, {"rings", o.grid.rings}, {"ring_length", o.grid.ring_length}}},
      {"lmax", options.lmax},
      {"fields", options.fields},
      {"seed", options.seed},
      {"runs", options.runs},
      {"max_error", o.error.max},
      {"rms_error", o.error.rms},
      {"bound", o.bound},
      {"passed", o.passed()},
      {"setup_seconds", o.setup_seconds},
      {"synthesis_seconds", o.synthesis.seconds},
      {"analysis_seconds", o.analysis.seconds},
      {"synthesis", stage_json(o.synthesis)},
      {"analysis", stage_json(o.analysis)},
      {"memory",
       {{"host_bytes", o.memory.host}, {"device_bytes", o.memory.device}, {"peak_resident_bytes", peak_resident()}}}};
  write_stdout(json_text(all) + "\n");
}

std::string memory_text(const MemoryNeed& need) {
  return fmt::format("at most {} MiB on the host and {} MiB on the device", (need.host >> 20) + 1,
                     (need.device + (1 << 20) - 1) >> 20);
}

void write_head(const Options& options, const RoundtripResult& o, const std::string& note) {
  write_stdout(fmt::format("round trip: {} of random coefficients to degree {} (uniform in [-0.5, 0.5], seed {})\n",
                           options.fields == 1 ? "1 field" : fmt::format("{} fields", options.fields), options.lmax,
                           options.seed));
  write_stdout(fmt::format("grid: {}, {} rings of {} points\n", name(o.grid.kind), o.grid.rings, o.grid.ring_length));
  if (!note.empty()) write_stdout("note: " + note + "\n");
  write_stdout("device: " + device_line(o.device) + "\n");
}

void write_text(const Options& options, const RoundtripResult& o, const std::string& note) {
  write_head(options, o, note);
  write_stdout(fmt::format("  {:<18} {:.2e}  largest error over largest coefficient (bound {:.1e}: {})\n", "max_error",
                           o.error.max, o.bound, o.passed() ? "passed" : "FAILED"));
  write_stdout(fmt::format("  {:<18} {:.2e}  root mean square, relative\n", "rms_error", o.error.rms));
  const auto seconds = [](const char* what, double value, const char* remark) {
    write_stdout(fmt::format("  {:<18} {:.6f} s{}\n", what, value, remark));
  };
  seconds("set-up", o.setup_seconds, "  nodes, weights, recurrences");
  seconds("synthesis", o.synthesis.seconds,
          options.runs == 1 ? "  after one to warm up" : "  median after one to warm up");
  seconds("analysis", o.analysis.seconds, "");
  write_stdout(
      fmt::format("  {:<18} {}; peak of the process {} MiB\n", "memory", memory_text(o.memory), peak_resident() >> 20));
}

void run(const Options& options, const Common& common) {
  std::string note;
  const auto backend = open_backend(common, &note);
  if (!note.empty() && !common.quiet) say(fmt::format("cowgpu: {}\n", note));
  const RoundtripRequest request = {options.lmax, options.fields, *grid_kind_named(options.grid), options.seed,
                                    options.runs};
  if (options.dry_run) {
    const RoundtripResult plan = plan_roundtrip(request, *backend);
    write_head(options, plan, note);
    write_stdout("memory: " + memory_text(plan.memory) + "\n");
    return;
  }
  ConsoleMonitor monitor(common.style());
  const RoundtripResult result = roundtrip(request, *backend, monitor);
  monitor.clear();
  if (options.json)
    write_json(options, common, result, note);
  else
    write_text(options, result, note);
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
      ->check(in_range(1, 1000))
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
