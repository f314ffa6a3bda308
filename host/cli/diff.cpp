#include "host/cli/commands.hpp"

#include "host/cli/quantities.hpp"
#include "host/error.hpp"
#include "host/io/document_json.hpp"
#include "host/requests/diff.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string first, second;
  std::string of, field;
  std::string normalisation = "orthonormal", phase = "cs";
  std::optional<double> tolerance;
  std::string length_unit;
  bool json = false;
};

void run(const Options& options, const Common& common) {
  DiffRequest request;
  request.first = options.first;
  request.second = options.second;
  request.of = options.of;
  request.field = options.field;
  request.convention = {*normalisation_named(options.normalisation), *phase_named(options.phase)};
  request.metres = stated_metres(options.length_unit);
  request.tolerance = options.tolerance;
  DiffResult result = diff(request);
  result.command = common.command;
  if (options.json)
    write_json(document(result), write_stdout);
  else
    write_screen(result, write_stdout);
  const double worst = result.difference.worst();
  if (!options.tolerance || worst <= *options.tolerance) return;
  flush_stdout();
  throw Error(Fault::check_failed, fmt::format("{} and {} differ by {:.3g}, more than {:.3g}", options.first,
                                               options.second, worst, *options.tolerance));
}

} // namespace

void add_diff(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand("diff", "Two files of coefficients, degree by degree");
  command
      ->add_option("A", options->first, "Coefficients of any format that `convert` reads, recognised by their content")
      ->required();
  command->add_option("B", options->second, "Coefficients to compare, of any format and convention")->required();
  command
      ->add_option("--of", options->of,
                   "Expansion to take from results of `expand`: mass (default), harmonic, stretch, smooth or flow")
      ->type_name("NAME");
  command->add_option("--field", options->field, "Name of the field to take, where there are several")
      ->type_name("NAME");
  add_convention_options(*command, options->normalisation, options->phase, "of the norms");
  for (const char* option : {"--normalisation", "--phase"}) command->get_option(option)->capture_default_str();
  command
      ->add_option("--tolerance", options->tolerance,
                   "Exit with 1 where a degree differs by more than this part of the largest norm among it and its two "
                   "neighbours on each side")
      ->check(non_negative_number())
      ->type_name("T");
  add_length_unit_option(*command, options->length_unit, "A and B");
  command->add_flag("--json", options->json, "As JSON (data/schemas/cowgpu.diff.v1.json)");
  command->footer("B is brought to the kind and reference radius of A. Exit code 0, or 1 beyond --tolerance.\n"
                  "Example: cowgpu diff cow.json cow.gfc --tolerance 1e-15");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
