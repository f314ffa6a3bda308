#include "host/cli/commands.hpp"

#include "host/cli/quantities.hpp"
#include "host/clock.hpp"
#include "host/io/document_json.hpp"
#include "host/requests/transform.hpp"

#include <fmt/format.h>

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

// Opens the device; why it is the CPU goes to `notes`.
std::unique_ptr<Backend> open_noted(const Common& common, std::vector<std::string>& notes) {
  std::string note;
  auto backend = open_backend(common, &note);
  if (!note.empty()) {
    if (!common.quiet) say(fmt::format("cowgpu: {}\n", note));
    notes.push_back(note);
  }
  return backend;
}

// The result's file, opened before the work; none for a dry run.
std::unique_ptr<AtomicFile> open_output(const Options& options) {
  file_format(options.output);
  refuse_same_file(options.input, options.output);
  return options.dry_run ? nullptr : std::make_unique<AtomicFile>(options.output);
}

std::optional<GridKind> wanted_kind(const Options& options) {
  return options.grid.empty() ? std::nullopt : grid_kind_named(options.grid);
}

// What a direction does between reading its input and saying what was done: the transform, and its file.
template <class Request, class Transform, class Write>
void run(const Options& options, const Common& common, Request request, double read_seconds, const Transform& transform,
         AtomicFile* file, const Write& write) {
  const auto backend = open_noted(common, request.input.notes);
  if (options.dry_run) return write_plan(plan_transform(request, *backend), write_stdout);
  ConsoleMonitor monitor(common.style());
  auto result = transform(request, *backend, monitor);
  monitor.clear();
  TransformRun& run = result.run;
  const auto start = Clock::now();
  write(result, *file);
  check_stop(ConsoleMonitor(ProgressStyle::none));
  file->commit();
  run.write_seconds = seconds_since(start);
  run.read_seconds = read_seconds;
  run.command = common.command;
  run.output = options.output;
  if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  if (options.json)
    write_json(document(run), write_stdout);
  else
    write_screen(run, write_stdout);
}

void run_analysis(const Options& options, const Common& common) {
  const auto file = open_output(options);
  const auto start = Clock::now();
  AnalyseRequest request{read_grid(options.input, wanted_kind(options)),
                         options.input,
                         options.lmax,
                         {*normalisation_named(options.normalisation), *phase_named(options.phase)}};
  run(options, common, std::move(request), seconds_since(start), analyse, file.get(),
      [&](const AnalyseResult& result, AtomicFile& to) {
        write_coefficient_set(result.coefficients, coefficient_format(options.output), to);
      });
}

void run_synthesis(const Options& options, const Common& common) {
  const auto file = open_output(options);
  const auto start = Clock::now();
  SynthesiseRequest request{read_fields(options.input, stated_metres(options.length_unit)), options.input, options.lmax,
                            *wanted_kind(options)};
  run(options, common, std::move(request), seconds_since(start), synthesise, file.get(),
      [&](const SynthesiseResult& result, AtomicFile& to) {
        const FileFormat format = file_format(options.output);
        const std::uint64_t bytes = csv_number * std::uint64_t(result.grid.fields() + 2) * result.grid.grid.points();
        if (format == FileFormat::csv && !common.quiet && bytes > large_csv)
          say(fmt::format("cowgpu: the CSV will have about {} MB; a name that ends in .nc gives a smaller file\n",
                          bytes / 1000000));
        write_grid(result.grid, format, to);
      });
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
  command->callback([options, &common] { run_analysis(*options, common); });
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
  command->callback([options, &common] { run_synthesis(*options, common); });
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
