#include "host/cli/commands.hpp"

#include "host/cli/quantities.hpp"
#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/grid_file.hpp"
#include "host/report/json_parts.hpp"
#include "host/report/result.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <system_error>
#include <utility>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string input, output, length_unit;
  int lmax = -1;    // -1: the file's
  std::string grid; // empty: the file's
  std::string normalisation = "orthonormal", phase = "cs";
  bool json = false;
  bool dry_run = false;
};

constexpr std::uint64_t large_csv = std::uint64_t(50) << 20;
constexpr std::uint64_t csv_number = 20; // bytes, about

// One run of either direction.
struct Run {
  const char* what = "";
  const SphereGrid* grid = nullptr;
  int lmax = 0;
  std::vector<std::string> names, notes;
  Convention convention; // convention of the coefficients in the file
  DeviceFacts device;
  TransformReport report;
  double read_seconds = 0, setup_seconds = 0, write_seconds = 0;
};

std::string grid_text(const SphereGrid& grid) {
  return fmt::format("{}, {} rings of {} points, exact to degree {}", name(grid.kind), grid.rings, grid.ring_length,
                     grid.lmax);
}

std::string fields_text(std::size_t n) {
  return n == 1 ? "1 field" : fmt::format("{} fields", n);
}

// Input, result, the same as real coefficients, the file's image.
MemoryNeed memory_need(const SphereGrid& grid, int lmax, int fields, const Backend& backend) {
  MemoryNeed need = backend.sphere_transform_memory(grid, lmax, fields);
  const auto n = std::uint64_t(fields), degrees = std::uint64_t(lmax) + 1;
  need.host += n * (16 * grid.points() + 32 * SphereCoefficients::count(lmax) + 8 * degrees * degrees);
  return need;
}

void write_plan(const Run& run, const MemoryNeed& need) {
  write_stdout(fmt::format("plan: {} of {} to degree {}, {} coefficients each\n", run.what,
                           fields_text(run.names.size()), run.lmax, SphereCoefficients::count(run.lmax)));
  write_stdout("grid: " + grid_text(*run.grid) + "\n");
  write_stdout("device: " + device_line(run.device) + "\n");
  write_stdout(fmt::format("memory: at most {} MiB on the host and {} MiB on the device, files and all\n",
                           (need.host >> 20) + 1, (need.device + (1 << 20) - 1) >> 20));
}

void write_report(const Options& options, const Common& common, const Run& run) {
  if (options.json) {
    const nlohmann::ordered_json all = {{"schema", "cowgpu.transform.v1"},
                                        {"program", program_json()},
                                        {"command", common.command},
                                        {"created", utc_now()},
                                        {"direction", run.what},
                                        {"input", options.input},
                                        {"output", options.output},
                                        {"grid",
                                         {{"kind", name(run.grid->kind)},
                                          {"rings", run.grid->rings},
                                          {"ring_length", run.grid->ring_length},
                                          {"lmax", run.grid->lmax}}},
                                        {"lmax", run.lmax},
                                        {"fields", run.names},
                                        {"normalisation", name(run.convention.normalisation)},
                                        {"phase", name(run.convention.phase)},
                                        {"device", device_json(run.device)},
                                        {"notes", run.notes},
                                        {"timings",
                                         {{"read", run.read_seconds},
                                          {"setup", run.setup_seconds},
                                          {"transform", run.report.seconds},
                                          {"write", run.write_seconds}}}};
    write_stdout(json_text(all) + "\n");
    return;
  }
  for (const std::string& note : run.notes) write_stdout("note: " + note + "\n");
  write_stdout(fmt::format("computed: {} of {} to degree {}, {} coefficients each, in {:.3f} s\n", run.what,
                           fields_text(run.names.size()), run.lmax, SphereCoefficients::count(run.lmax),
                           run.report.seconds));
  write_stdout("grid: " + grid_text(*run.grid) + "\n");
  write_stdout(fmt::format("coefficients in the file: {}\n", convention_text(run.convention)));
  write_stdout("device: " + device_line(run.device) + "\n");
  write_stdout(fmt::format("time: read {:.3f} s, set-up {:.3f} s, transform {:.3f} s, write {:.3f} s\n",
                           run.read_seconds, run.setup_seconds, run.report.seconds, run.write_seconds));
}

// Opens the device; the transform too unless it is a dry run.
std::unique_ptr<SphereTransform> prepare(const Options& options, const Common& common, Run& run) {
  const auto start = Clock::now();
  std::string note;
  const auto backend = open_backend(common, &note);
  if (!note.empty()) {
    if (!common.quiet) say(fmt::format("cowgpu: {}\n", note));
    run.notes.push_back(note);
  }
  run.device = backend->facts();
  const MemoryNeed need = memory_need(*run.grid, run.lmax, int(run.names.size()), *backend);
  check_memory(need, *backend, "lower --lmax or transform fewer fields at once");
  if (options.dry_run) {
    write_plan(run, need);
    return nullptr;
  }
  auto transform = backend->sphere_transform(*run.grid, run.lmax);
  run.setup_seconds = seconds_since(start);
  return transform;
}

// The result's file, opened before the work; none for a dry run.
std::unique_ptr<AtomicFile> open_output(const Options& options) {
  file_format(options.output);
  refuse_same_file(options.input, options.output);
  return options.dry_run ? nullptr : std::make_unique<AtomicFile>(options.output);
}

void finish(const Options& options, const Common& common, AtomicFile& file, Run& run, Clock::time_point start) {
  check_stop(ConsoleMonitor(ProgressStyle::none));
  file.commit();
  run.write_seconds = seconds_since(start);
  if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  write_report(options, common, run);
}

// Data near the end of double's range overflow in sums.
[[noreturn]] void refuse_overflow(const Options& options, const Run& run) {
  throw Error(Fault::file_format, fmt::format("{}: the {} of these values overflows double precision; scale them down",
                                              options.input, run.what));
}

std::optional<GridKind> wanted_kind(const Options& options) {
  return options.grid.empty() ? std::nullopt : grid_kind_named(options.grid);
}

void analyse(const Options& options, const Common& common) {
  const auto file = open_output(options);
  auto start = Clock::now();
  GridFile in = read_grid(options.input, wanted_kind(options));
  Run run;
  run.read_seconds = seconds_since(start);
  run.what = "analysis";
  run.grid = &in.grid;
  run.lmax = options.lmax < 0 ? in.lmax : options.lmax;
  run.names = in.names;
  run.notes = in.notes;
  run.convention = {*normalisation_named(options.normalisation), *phase_named(options.phase)};
  if (run.lmax > in.grid.lmax)
    throw Error(Fault::bad_argument,
                fmt::format("--lmax {}: the {} rings of {} points of {} give back degrees up to {} "
                            "only; lower --lmax or bring a finer grid",
                            run.lmax, in.grid.rings, in.grid.ring_length, options.input, in.grid.lmax));
  const auto transform = prepare(options, common, run);
  if (!transform) return;
  CoefficientFile out;
  out.coefficients = SphereCoefficients(run.lmax, in.fields());
  out.convention = run.convention;
  if (in.names != field_names({}, in.fields(), "value")) out.names = in.names;
  ConsoleMonitor monitor(common.style());
  transform->analyse(in.fields(), in.values, out.coefficients.values, monitor, &run.report);
  monitor.clear();
  for (const std::complex<double>& a : out.coefficients.values)
    if (!std::isfinite(a.real()) || !std::isfinite(a.imag())) refuse_overflow(options, run);
  start = Clock::now();
  write_coefficients(out, file_format(options.output), *file);
  finish(options, common, *file, run, start);
}

// The coefficients up to degree lmax, or with zeros above.
SphereCoefficients resized(const SphereCoefficients& a, int lmax) {
  SphereCoefficients b(lmax, a.fields);
  for (int f = 0; f < a.fields; ++f)
    for (int m = 0; m <= std::min(a.lmax, lmax); ++m)
      for (int l = m; l <= std::min(a.lmax, lmax); ++l) b.at(f, l, m) = a.at(f, l, m);
  return b;
}

void synthesise(const Options& options, const Common& common) {
  const auto file = open_output(options);
  auto start = Clock::now();
  CoefficientFile in = read_coefficients(options.input, stated_metres(options.length_unit));
  Run run;
  run.read_seconds = seconds_since(start);
  run.what = "synthesis";
  run.names = field_names(in.names, in.coefficients.fields, "value");
  run.notes = in.notes;
  run.convention = in.convention;
  GridFile out;
  out.lmax = options.lmax < 0 ? in.coefficients.lmax : options.lmax;
  run.lmax = std::min(out.lmax, in.coefficients.lmax);
  if (run.lmax < in.coefficients.lmax) {
    run.notes.push_back(fmt::format("degrees {} to {} were left out", run.lmax + 1, in.coefficients.lmax));
    in.coefficients = resized(in.coefficients, run.lmax);
  }
  start = Clock::now();
  out.grid = make_grid(*wanted_kind(options), out.lmax);
  const double grid_seconds = seconds_since(start);
  run.grid = &out.grid;
  const int fields = in.coefficients.fields;
  if (file_format(options.output) == FileFormat::csv && !common.quiet &&
      csv_number * std::uint64_t(fields + 2) * out.grid.points() > large_csv)
    say(fmt::format("cowgpu: the CSV will have about {} MB; a name that ends in .nc gives a smaller file\n",
                    csv_number * std::uint64_t(fields + 2) * out.grid.points() / 1000000));
  const auto transform = prepare(options, common, run);
  if (!transform) return;
  run.setup_seconds += grid_seconds;
  out.convention = in.convention;
  out.names = run.names;
  out.values.resize(std::size_t(fields) * out.grid.points());
  ConsoleMonitor monitor(common.style());
  transform->synthesise(fields, in.coefficients.values, out.values, monitor, &run.report);
  monitor.clear();
  if (!std::all_of(out.values.begin(), out.values.end(), [](double v) { return std::isfinite(v); }))
    refuse_overflow(options, run);
  start = Clock::now();
  write_grid(out, file_format(options.output), *file);
  finish(options, common, *file, run, start);
}

void add_direction_options(Command& command, Options& options, Common& common) {
  command.add_flag("--json", options.json, "A report as JSON on stdout (data/schemas/cowgpu.transform.v1.json)");
  command.add_flag("--dry-run", options.dry_run, "Print the plan and the memory it needs, and stop");
  add_common_options(command, common);
}

void add_analyse(Command& transform, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = transform.add_subcommand("analyse", "Coefficients of the fields on a grid");
  command
      ->add_option("IN", options->input,
                   "Grid file, .nc (latitudes and longitudes in degrees, in any order; pyshtools' grids too) or .csv "
                   "(lat,lon,value)")
      ->required();
  command->add_option("OUT", options->output, "Coefficient file, .nc (as pyshtools writes them) or .csv (l,m,C,S)")
      ->required();
  add_degree_option(*command, options->lmax, "Largest degree, at most the grid's (default: the file's)");
  add_grid_option(
      *command, options->grid,
      "What the file's grid is: gl (Gauss-Legendre), cc (Clenshaw-Curtis, both poles), dh (Driscoll-Healy, n "
      "rings of 2n points), dh1 (n of n), f1 (Fejer: cell-centred) (default: as the file says)");
  add_convention_options(*command, options->normalisation, options->phase, "of the coefficients written");
  for (const char* option : {"--normalisation", "--phase"}) command->get_option(option)->capture_default_str();
  add_direction_options(*command, *options, common);
  command->footer(
      "The coefficients have the unit of the field: f = sum of K_lm P_lm(cos theta) (C_lm cos m phi + S_lm sin "
      "m phi),\ntheta = 90 degrees - lat, phi = lon; host/convention.hpp says what K_lm is.\n"
      "Example: cowgpu transform analyse topography.nc coefficients.nc --normalisation 4pi --phase none");
  command->callback([options, &common] { analyse(*options, common); });
}

void add_synthesise(Command& transform, Common& common) {
  const auto options = std::make_shared<Options>();
  options->grid = "gl";
  Command* command = transform.add_subcommand("synthesise", "Fields on a grid from their coefficients");
  command
      ->add_option("IN", options->input,
                   "Coefficients of any convention and of any format that `convert` reads, recognised by their content")
      ->required();
  command->add_option("OUT", options->output, "Grid file, .nc or .csv (lat,lon,value)")->required();
  add_degree_option(*command, options->lmax,
                    "Degree of the grid (default: the file's); coefficients above it are left out");
  add_grid_option(
      *command, options->grid,
      "gl (Gauss-Legendre), cc (Clenshaw-Curtis, both poles), dh (Driscoll-Healy, n rings of 2n points), dh1 "
      "(n of n), f1 (Fejer, cell-centred: n of 2n); for pyshtools take dh");
  command->get_option("--grid")->capture_default_str();
  add_length_unit_option(*command, options->length_unit, "IN");
  add_direction_options(*command, *options, common);
  command->footer("Values have the unit of the coefficients; latitudes and longitudes are in degrees.\n"
                  "Example: cowgpu transform synthesise coefficients.nc map.nc --grid dh --lmax 180");
  command->callback([options, &common] { synthesise(*options, common); });
}

} // namespace

void add_transform(Command& app, Common& common) {
  Command* command =
      app.add_subcommand("transform", "Spherical-harmonic transforms of fields on the sphere, to degree 8192");
  command->require_subcommand(1);
  add_analyse(*command, common);
  add_synthesise(*command, common);
  add_roundtrip(*command, common);
}

} // namespace cowgpu::cli
