#include "host/cli/commands.hpp"

#include "host/cli/quantities.hpp"
#include "host/error.hpp"
#include "host/report/json_parts.hpp"
#include "host/requests/diff.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

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

// Infinity has no place in JSON.
nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json json_of(const FieldDifference& field) {
  nlohmann::ordered_json degrees = nlohmann::ordered_json::array();
  for (std::size_t l = 0; l < field.norm.size(); ++l)
    degrees.push_back({{"l", l},
                       {"norm", field.norm[l]},
                       {"difference", field.difference[l]},
                       {"relative", number_or_null(field.relative(l))},
                       {"worst_m", field.worst_order[l]}});
  return {{"name", field.name},
          {"norm", field.total_norm},
          {"difference", field.total},
          {"relative", number_or_null(field.total_relative())},
          {"worst", number_or_null(field.worst)},
          {"worst_degree", field.worst_degree},
          {"degrees", degrees}};
}

void write_json(const Options& options, const Common& common, const CoefficientDifference& result,
                const std::vector<std::string>& notes) {
  nlohmann::ordered_json fields = nlohmann::ordered_json::array();
  for (const FieldDifference& field : result.fields) fields.push_back(json_of(field));
  nlohmann::ordered_json all = {{"schema", "cowgpu.diff.v1"},
                                {"program", program_json()},
                                {"command", common.command},
                                {"created", utc_now()},
                                {"first", options.first},
                                {"second", options.second},
                                {"notes", notes},
                                {"kind", name(result.kind)},
                                {"normalisation", name(result.convention.normalisation)},
                                {"phase", name(result.convention.phase)},
                                {"reference_radius", nullptr},
                                {"lmax", result.lmax},
                                {"unlike", result.unlike},
                                {"fields", fields},
                                {"worst", number_or_null(result.worst())},
                                {"tolerance", nullptr},
                                {"passed", nullptr}};
  if (result.reference_radius > 0) all["reference_radius"] = result.reference_radius;
  if (options.tolerance) {
    all["tolerance"] = *options.tolerance;
    all["passed"] = result.worst() <= *options.tolerance;
  }
  write_stdout(json_text(all) + "\n");
}

void write_screen(const Options& options, const CoefficientDifference& result, const std::vector<std::string>& notes) {
  write_stdout(fmt::format("A: {}\nB: {}\n", options.first, options.second));
  for (const std::string& note : notes) write_stdout("note: " + note + "\n");
  for (const std::string& sentence : result.unlike) write_stdout("unlike: " + sentence + "\n");
  write_stdout(
      fmt::format("compared as {}, {}{}, to degree {}\n", name(result.kind), convention_text(result.convention),
                  result.reference_radius > 0 ? fmt::format(", R = {}", result.reference_radius) : "", result.lmax));
  for (const FieldDifference& field : result.fields) {
    write_stdout(fmt::format("\n{}: |A| {:.6e}, |A - B| {:.3e}, relative {:.3e}\n", field.name, field.total_norm,
                             field.total, field.total_relative()));
    write_stdout(
        fmt::format("  {:>4}  {:>13}  {:>10}  {:>10}  {:>7}\n", "l", "|A_l|", "|A - B|", "relative", "worst m"));
    for (std::size_t l = 0; l < field.norm.size(); ++l)
      write_stdout(fmt::format("  {:>4}  {:>13.6e}  {:>10.3e}  {:>10.3e}  {:>7}\n", l, field.norm[l],
                               field.difference[l], field.relative(l), field.worst_order[l]));
  }
  write_stdout(fmt::format("\nworst degree over the norms beside it: {:.3e}{}\n", result.worst(),
                           !options.tolerance                     ? ""
                           : result.worst() <= *options.tolerance ? ", within the tolerance"
                                                                  : ", beyond the tolerance"));
}

void run(const Options& options, const Common& common) {
  DiffRequest request;
  request.first = options.first;
  request.second = options.second;
  request.of = options.of;
  request.field = options.field;
  request.convention = {*normalisation_named(options.normalisation), *phase_named(options.phase)};
  request.metres = stated_metres(options.length_unit);
  const auto [result, notes] = diff(request);
  if (options.json)
    write_json(options, common, result, notes);
  else
    write_screen(options, result, notes);
  if (!options.tolerance || result.worst() <= *options.tolerance) return;
  flush_stdout();
  throw Error(Fault::check_failed, fmt::format("{} and {} differ by {:.3g}, more than {:.3g}", options.first,
                                               options.second, result.worst(), *options.tolerance));
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
