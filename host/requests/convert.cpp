#include "host/requests/convert.hpp"

#include "host/bounds.hpp"
#include "host/error.hpp"
#include "host/io/coefficient_metadata.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace cowgpu {
namespace {

// What is asked for, and what the output's format asks for where nothing is.
ConversionTarget target_of(const ConvertRequest& request, const CoefficientSet& set) {
  const bool gfc = request.format == CoefficientFormat::gfc;
  const bool text = gfc || request.format == CoefficientFormat::shtools;
  ConversionTarget target = request.target;
  target.lmax.reset(); // the degrees above were left out before
  if (text && set.kind == CoefficientKind::multipoles && !target.kind) target.kind = CoefficientKind::potential;
  if (!target.form && request.format != CoefficientFormat::json && request.format != CoefficientFormat::csv)
    target.form = Form::real;
  const bool geodesy = target.kind == CoefficientKind::potential && set.kind == CoefficientKind::multipoles;
  if (!target.normalisation && (geodesy || (gfc && set.convention.normalisation != Normalisation::unnormalised)))
    target.normalisation = Normalisation::four_pi;
  if (!target.phase && (geodesy || gfc)) target.phase = Phase::none;
  return target;
}

// Where the file does not say its convention, what the user says of it. What it does say counts: an option may repeat it only.
void state_convention(const ConvertRequest& request, CoefficientSet& set) {
  if (!request.input_normalisation && !request.input_phase) return;
  const auto take = [&](const char* option, bool stated, auto given, auto& value) {
    if (!given) return;
    if (stated && *given != value)
      throw Error(Fault::bad_argument,
                  fmt::format("{0} {1}: {2} says {3} itself, and the option is for files that do not say it; leave it "
                              "out, or say {3}",
                              option, name(*given), request.input.string(), name(value)));
    value = *given;
  };
  const std::string assumed = assumed_convention(set);
  take("--input-normalisation", set.normalisation_stated, request.input_normalisation, set.convention.normalisation);
  take("--input-phase", set.phase_stated, request.input_phase, set.convention.phase);
  if (assumed.empty()) return;
  std::erase(set.notes, assumed);
  const auto by = [](bool stated, bool option) {
    return stated ? "as the file says" : option ? "as the option says" : "as was assumed";
  };
  set.notes.push_back(fmt::format(
      "IN was taken as {}, {}, and {} the Condon-Shortley phase, {}", name(set.convention.normalisation),
      by(set.normalisation_stated, request.input_normalisation.has_value()),
      set.convention.phase == Phase::none ? "without" : "with", by(set.phase_stated, request.input_phase.has_value())));
}

// Lengths are metres and densities kg/m^3.
void state_si(CoefficientSet& set) {
  set.length_unit = "m";
  set.mass_unit = "kg";
  set.gravitational_constant = gravitational_constant_si;
  if (set.kind == CoefficientKind::potential && set.mass) set.gm = *set.mass * gravitational_constant_si;
}

// A radius in the numbers of the set.
double radius_of(const char* option, const Measure& radius, const ConvertRequest& request, const CoefficientSet& set) {
  if (radius.has_unit && !set.in_metres())
    throw Error(Fault::bad_argument,
                fmt::format("{} {} m: a length with a unit needs that of {}: add --length-unit, or give a bare number "
                            "in the file's unit",
                            option, radius.value, request.input.string()));
  if (!radius.has_unit && request.metres)
    throw Error(Fault::bad_argument,
                fmt::format("{0} {1}: with --length-unit it needs a unit of its own, since {1} of the file's unit and "
                            "{1} m differ: such as {1}km or {1}m",
                            option, radius.value));
  return radius.value;
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

void check(const ConvertRequest& request) {
  const ConversionTarget& target = request.target;
  require_member("the kind is", target.kind.value_or(CoefficientKind::field), CoefficientKind::potential);
  require_member("the form is", target.form.value_or(Form::real), Form::complex);
  for (const auto& normalisation : {target.normalisation, request.input_normalisation})
    require_member("the normalisation is", normalisation.value_or(Normalisation::four_pi), Normalisation::unnormalised);
  for (const auto& phase : {target.phase, request.input_phase})
    require_member("the phase is", phase.value_or(Phase::none), Phase::none);
  require_member("the format is", request.format, CoefficientFormat::shtools);
}

} // namespace

ConvertResult convert(const ConvertRequest& request, Monitor& monitor, unsigned threads) {
  check(request);
  const std::string input = request.input.string();
  ConvertResult result;
  result.input = read_in_unit(request.input, request.of, request.metres);
  state_convention(request, result.input);
  CoefficientSet set = result.input;
  if (request.si) state_si(set);
  if (request.brillouin_radius)
    state_radius(radius_of("--brillouin-radius", *request.brillouin_radius, request, set), input, set);
  if (!request.field.empty()) set = single_field(set, request.field);
  if (const auto lmax = request.target.lmax) {
    if (*lmax > set.lmax)
      throw Error(
          Fault::bad_argument,
          fmt::format("--lmax {}: {} goes to degree {}, and convert only leaves degrees out", *lmax, input, set.lmax));
    ConversionTarget shorter;
    shorter.lmax = lmax;
    set = converted(set, shorter);
  }
  if (request.rotation) {
    set = rotated(set, *request.rotation, monitor, threads);
    set.remarks.emplace_back(fmt::format("rotation_{}", set.remarks.size() + 1),
                             fmt::format("R_z(A) R_y(B) R_z(C) about the origin, A,B,C = {}", request.rotation_text));
  }
  ConversionTarget target = target_of(request, set);
  if (request.reference_radius)
    target.reference_radius = radius_of("--reference-radius", *request.reference_radius, request, set);
  result.output = converted(set, target);
  result.notes = std::move(set.notes);
  return result;
}

} // namespace cowgpu
