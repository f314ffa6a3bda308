#include "host/cli/commands.hpp"

#include "host/cli/quantities.hpp"
#include "host/error.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/coefficient_metadata.hpp"
#include "host/spectrum/convert.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string input, output;
  std::string of, field;
  std::string kind, form, normalisation, phase;
  std::string input_normalisation, input_phase;
  std::optional<double> reference_radius, brillouin_radius;
  std::optional<int> lmax;
  std::string rotation, angle_unit = "degrees";
  bool si = false;
  std::string length_unit;
};

// What is asked for, and what the output's format asks for where nothing is.
ConversionTarget target_of(const Options& options, const CoefficientSet& set) {
  const CoefficientFormat format = coefficient_format(options.output);
  const bool gfc = format == CoefficientFormat::gfc, text = gfc || format == CoefficientFormat::shtools;
  ConversionTarget target;
  target.reference_radius = options.reference_radius;
  if (!options.kind.empty()) target.kind = kind_named(options.kind);
  if (!options.form.empty()) target.form = form_named(options.form);
  if (!options.normalisation.empty()) target.normalisation = normalisation_named(options.normalisation);
  if (!options.phase.empty()) target.phase = phase_named(options.phase);
  if (text && set.kind == CoefficientKind::multipoles && !target.kind) target.kind = CoefficientKind::potential;
  if (!target.form && format != CoefficientFormat::json && format != CoefficientFormat::csv) target.form = Form::real;
  const bool geodesy = target.kind == CoefficientKind::potential && set.kind == CoefficientKind::multipoles;
  if (!target.normalisation && (geodesy || (gfc && set.convention.normalisation != Normalisation::unnormalised)))
    target.normalisation = Normalisation::four_pi;
  if (!target.phase && (geodesy || gfc)) target.phase = Phase::none;
  return target;
}

EulerAngles angles_of(const Options& options) {
  const auto angles = parse_point(options.rotation);
  if (!angles)
    throw Error(Fault::bad_argument,
                fmt::format("--rotate {}: it must be three numbers ALPHA,BETA,GAMMA", options.rotation));
  const long double unit = options.angle_unit == "degrees" ? std::numbers::pi_v<long double> / 180 : 1;
  return {double(angles->x() * unit), double(angles->y() * unit), double(angles->z() * unit)};
}

// Where the file does not say its convention, what the user says of it. What it does say counts: an option may repeat it only.
void state_convention(const Options& options, CoefficientSet& set) {
  if (options.input_normalisation.empty() && options.input_phase.empty()) return;
  const auto take = [&](const char* option, bool stated, auto given, auto& value) {
    if (!given) return;
    if (stated && *given != value)
      throw Error(Fault::bad_argument,
                  fmt::format("{0} {1}: {2} says {3} itself, and the option is for files that do not say it; leave it "
                              "out, or say {3}",
                              option, name(*given), options.input, name(value)));
    value = *given;
  };
  const std::string assumed = assumed_convention(set);
  take("--input-normalisation", set.normalisation_stated, normalisation_named(options.input_normalisation),
       set.convention.normalisation);
  take("--input-phase", set.phase_stated, phase_named(options.input_phase), set.convention.phase);
  if (assumed.empty()) return;
  std::erase(set.notes, assumed);
  const auto by = [](bool stated, const std::string& option) {
    return stated ? "as the file says" : option.empty() ? "as was assumed" : "as the option says";
  };
  set.notes.push_back(
      fmt::format("IN was taken as {}, {}, and {} the Condon-Shortley phase, {}", name(set.convention.normalisation),
                  by(set.normalisation_stated, options.input_normalisation),
                  set.convention.phase == Phase::none ? "without" : "with", by(set.phase_stated, options.input_phase)));
}

// Lengths are metres and densities kg/m^3.
void state_si(CoefficientSet& set) {
  set.length_unit = "m";
  set.mass_unit = "kg";
  set.gravitational_constant = gravitational_constant_si;
  if (set.kind == CoefficientKind::potential && set.mass) set.gm = *set.mass * gravitational_constant_si;
}

// The sphere that holds the body, where the file does not say it.
void state_radius(double radius, const std::string& file, CoefficientSet& set) {
  if (set.kind == CoefficientKind::field)
    throw Error(Fault::bad_argument,
                fmt::format("--brillouin-radius is of a body, and {} holds coefficients of other fields", file));
  if (!(radius > 0) || !std::isfinite(radius))
    throw Error(Fault::bad_argument, fmt::format("--brillouin-radius {}: it must be above 0", radius));
  if (set.brillouin_radius && *set.brillouin_radius != radius)
    throw Error(Fault::bad_argument,
                fmt::format("--brillouin-radius {}: {} says that it is {}", radius, file, *set.brillouin_radius));
  set.brillouin_radius = radius;
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

void run(const Options& options, const Common& common) {
  const CoefficientFormat format = coefficient_format(options.output);
  refuse_same_file(options.input, options.output);
  std::optional<EulerAngles> angles;
  if (!options.rotation.empty()) angles = angles_of(options);
  AtomicFile file(options.output); // before long work: a result that cannot be written should fail now
  CoefficientSet set = read_in_unit(options.input, options.of, stated_metres(options.length_unit));
  state_convention(options, set);
  const std::string before = described(set);
  if (options.si) state_si(set);
  if (options.brillouin_radius) state_radius(*options.brillouin_radius, options.input, set);
  if (!options.field.empty()) set = single_field(set, options.field);
  if (options.lmax && *options.lmax > set.lmax)
    throw Error(Fault::bad_argument, fmt::format("--lmax {}: {} goes to degree {}, and convert only leaves degrees out",
                                                 *options.lmax, options.input, set.lmax));
  ConversionTarget shorter;
  shorter.lmax = options.lmax;
  if (options.lmax) set = converted(set, shorter);
  if (angles) {
    ConsoleMonitor monitor(common.style());
    set = rotated(set, *angles, monitor, common.threads);
    monitor.clear();
    set.remarks.emplace_back(
        fmt::format("rotation_{}", set.remarks.size() + 1),
        fmt::format("R_z(A) R_y(B) R_z(C) about the origin, A,B,C = {} {}", options.rotation, options.angle_unit));
  }
  CoefficientSet result = converted(set, target_of(options, set));
  std::string& history = result.provenance.history;
  history += fmt::format("{}{}", history.empty() ? "" : "; ", fmt::join(common.command, " "));
  write_coefficient_set(result, format, file);
  check_stop(ConsoleMonitor(ProgressStyle::none));
  file.commit();
  if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  for (const std::string& note : set.notes) write_stdout("note: " + note + "\n");
  write_stdout(fmt::format("from: {}\nto:   {}\n", before, described(result)));
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
      ->add_option("--reference-radius", options->reference_radius, "Reference radius of OUT, in the length unit of IN")
      ->type_name("R")
      ->check(not_empty());
  command
      ->add_option("--brillouin-radius", options->brillouin_radius,
                   "Radius of the sphere about the origin of IN that holds the body, in the length unit of IN, where "
                   "IN does not say it")
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
