#include "host/cli/commands.hpp"

#include "host/cli/quantities.hpp"
#include "host/error.hpp"
#include "host/io/coefficient_metadata.hpp"
#include "host/requests/convert.hpp"

#include <fmt/format.h>

#include <numbers>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string input, output;
  std::string of, field;
  std::string kind, form, normalisation, phase;
  std::string input_normalisation, input_phase;
  std::string reference_radius, brillouin_radius;
  std::optional<int> lmax;
  std::string rotation, angle_unit = "degrees";
  bool si = false;
  std::string length_unit;
};

EulerAngles angles_of(const Options& options) {
  const auto angles = parse_point(options.rotation);
  if (!angles)
    throw Error(Fault::bad_argument,
                fmt::format("--rotate {}: it must be three numbers ALPHA,BETA,GAMMA", options.rotation));
  const long double unit = options.angle_unit == "degrees" ? std::numbers::pi_v<long double> / 180 : 1;
  return {double(angles->x() * unit), double(angles->y() * unit), double(angles->z() * unit)};
}

std::optional<Measure> radius_of(const char* option, const std::string& text) {
  if (text.empty()) return {};
  return parse_measure(option, text, Dimension::length);
}

std::string described(const CoefficientSet& set) {
  std::string text =
      fmt::format("{} to degree {}, {}, {}", name(set.kind), set.lmax, name(set.form), convention_text(set.convention));
  if (set.fields > 1) text = fmt::format("{} fields: ", set.fields) + text;
  if (set.reference_radius) text += fmt::format(", R = {}", *set.reference_radius);
  if (set.kind != CoefficientKind::field)
    text += set.brillouin_radius ? fmt::format(", Brillouin radius = {}", *set.brillouin_radius)
                                 : ", Brillouin radius not known";
  if (set.gm) text += fmt::format(", GM = {}", *set.gm);
  if (const std::string field = coefficients_of(set); !field.empty()) text += "\n      coefficients of " + field;
  return text;
}

ConvertRequest request_of(const Options& options, CoefficientFormat format) {
  ConvertRequest request;
  request.input = options.input;
  request.of = options.of;
  request.field = options.field;
  request.input_normalisation = normalisation_named(options.input_normalisation);
  request.input_phase = phase_named(options.input_phase);
  request.brillouin_radius = radius_of("--brillouin-radius", options.brillouin_radius);
  request.reference_radius = radius_of("--reference-radius", options.reference_radius);
  request.metres = stated_metres(options.length_unit);
  request.si = options.si;
  if (!options.rotation.empty()) request.rotation = angles_of(options);
  request.rotation_text = options.rotation + " " + options.angle_unit;
  request.target = {kind_named(options.kind),
                    form_named(options.form),
                    normalisation_named(options.normalisation),
                    phase_named(options.phase),
                    {},
                    options.lmax};
  request.format = format;
  return request;
}

void run(const Options& options, const Common& common) {
  const CoefficientFormat format = coefficient_format(options.output);
  refuse_same_file(options.input, options.output);
  const ConvertRequest request = request_of(options, format);
  AtomicFile file(options.output); // before long work: a result that cannot be written should fail now
  ConsoleMonitor monitor(common.style());
  ConvertResult result = convert(request, monitor, common.threads);
  monitor.clear();
  std::string& history = result.output.provenance.history;
  history += fmt::format("{}{}", history.empty() ? "" : "; ", fmt::join(common.command, " "));
  write_coefficient_set(result.output, format, file);
  check_stop(ConsoleMonitor(ProgressStyle::none));
  file.commit();
  if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  for (const std::string& note : result.notes) write_stdout("note: " + note + "\n");
  write_stdout(fmt::format("from: {}\nto:   {}\n", described(result.input), described(result.output)));
}

} // namespace

void add_convert(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand("convert", "Coefficients in another file format, convention, radius or frame");
  command
      ->add_option("IN", options->input,
                   "Coefficients, recognised by their content: JSON or CSV (of `expand` or `convert`), netCDF (as "
                   "pyshtools writes "
                   "them), ICGEM's .gfc, SHTOOLS text, gravity tables (SHADR: .tab, .sha, .txt ...)")
      ->required();
  command->add_option("OUT", options->output, "FILE.json, .csv, .nc, .gfc or .sh")->required();
  command
      ->add_option("--of", options->of,
                   "Expansion to take from a result of `expand`: mass (default), harmonic, stretch, smooth or flow")
      ->type_name("NAME");
  command->add_option("--field", options->field, "Name of the field to take, where there are several, such as f_r")
      ->type_name("NAME");
  add_convention_options(*command, options->normalisation, options->phase, "of OUT (default: that of IN)");
  command->add_option("--form", options->form, "Form of OUT: real (C, S) or complex (re, im; .json and .csv)")
      ->check(one_of({"real", "complex"}));
  command
      ->add_option("--kind", options->kind,
                   "Kind of OUT, where IN is of a body: multipoles (Q_lm / R^l) or potential (C_lm of geodesy; what "
                   ".gfc and .sh hold)")
      ->check(one_of({"multipoles", "potential"}));
  command
      ->add_option("--reference-radius", options->reference_radius,
                   "Reference radius of OUT, in the length unit of IN or with its own, such as 1738km")
      ->type_name("R")
      ->check(not_empty());
  command
      ->add_option(
          "--brillouin-radius", options->brillouin_radius,
          "Radius of the sphere about the origin of IN that holds the body, where IN does not say it; in the length "
          "unit of IN, or with its own, such as 1738km, as it must be with --length-unit")
      ->type_name("R")
      ->check(not_empty());
  command
      ->add_option("--rotate", options->rotation,
                   "Turn the body about its origin (or the fields) by R_z(ALPHA) R_y(BETA) R_z(GAMMA), the rightmost "
                   "first")
      ->type_name("ALPHA,BETA,GAMMA")
      ->check(not_empty());
  command->add_option("--angle-unit", options->angle_unit, "Unit of the angles of --rotate: degrees or radians")
      ->check(one_of({"degrees", "radians"}))
      ->capture_default_str();
  add_degree_option(*command, options->lmax.emplace(-1), "Leave out the degrees above L");
  command
      ->add_option("--input-normalisation", options->input_normalisation,
                   "Normalisation of IN, where it does not say it (default: 4pi)")
      ->check(one_of({"orthonormal", "4pi", "schmidt", "unnormalised"}));
  command->add_option("--input-phase", options->input_phase, "Phase of IN, where it does not say it (default: none)")
      ->check(one_of({"cs", "none"}));
  command->add_flag("--si", options->si,
                    "Lengths of IN are metres and its density is in kg/m^3: GM = 6.6743e-11 m^3/(kg s^2) M");
  add_length_unit_option(*command, options->length_unit, "IN");
  command->get_option("--si")->excludes(command->get_option("--length-unit"));
  add_run_options(*command, common);
  command->footer(
      "Coefficients are of a field on the unit sphere, and it is the same field in every convention. Of multipoles "
      "that is\n"
      "f = sum of conj(Q_lm) / R^l Y_lm, Q_lm = integral of density r^l Y_lm with orthonormal Y_lm: --normalisation\n"
      "4pi gives the 4pi coefficients of f, which are Q_lm / (R^l sqrt(4 pi)) and no moments with other Y_lm. Of a\n"
      "potential (--kind potential) it is f = V R / GM at r = R. Files say it as coefficients_of.\n"
      "host/convention.hpp and host/coefficient_set.hpp say what the conventions are.\n"
      "Example: cowgpu expand benchmark --lmax 64 -o cow.json && cowgpu convert cow.json cow.gfc");
  command->callback([options, &common] {
    if (*options->lmax < 0) options->lmax.reset();
    run(*options, common);
  });
}

} // namespace cowgpu::cli
