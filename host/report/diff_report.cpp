#include "host/report/diff_report.hpp"

#include "host/io/coefficient_metadata.hpp"
#include "host/report/json_parts.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace cowgpu {
namespace {

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

} // namespace

void write_screen(const DiffResult& found, const Sink& sink) {
  const CoefficientDifference& result = found.difference;
  sink(fmt::format("A: {}\nB: {}\n", found.first, found.second));
  for (const std::string& note : found.notes) sink("note: " + note + "\n");
  for (const std::string& sentence : result.unlike) sink("unlike: " + sentence + "\n");
  sink(fmt::format("compared as {}, {}{}, to degree {}\n", name(result.kind), convention_text(result.convention),
                   result.reference_radius > 0 ? fmt::format(", R = {}", result.reference_radius) : "", result.lmax));
  for (const FieldDifference& field : result.fields) {
    sink(fmt::format("\n{}: |A| {:.6e}, |A - B| {:.3e}, relative {:.3e}\n", field.name, field.total_norm, field.total,
                     field.total_relative()));
    sink(fmt::format("  {:>4}  {:>13}  {:>10}  {:>10}  {:>7}\n", "l", "|A_l|", "|A - B|", "relative", "worst m"));
    for (std::size_t l = 0; l < field.norm.size(); ++l)
      sink(fmt::format("  {:>4}  {:>13.6e}  {:>10.3e}  {:>10.3e}  {:>7}\n", l, field.norm[l], field.difference[l],
                       field.relative(l), field.worst_order[l]));
  }
  sink(fmt::format("\nworst degree over the norms beside it: {:.3e}{}\n", result.worst(),
                   !found.tolerance                     ? ""
                   : result.worst() <= *found.tolerance ? ", within the tolerance"
                                                        : ", beyond the tolerance"));
}

void write_json(const DiffResult& found, const Sink& sink) {
  const CoefficientDifference& result = found.difference;
  nlohmann::ordered_json fields = nlohmann::ordered_json::array();
  for (const FieldDifference& field : result.fields) fields.push_back(json_of(field));
  nlohmann::ordered_json all = {{"schema", "cowgpu.diff.v1"},
                                {"program", program_json()},
                                {"command", found.command},
                                {"created", found.created},
                                {"first", found.first},
                                {"second", found.second},
                                {"notes", found.notes},
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
  if (found.tolerance) {
    all["tolerance"] = *found.tolerance;
    all["passed"] = result.worst() <= *found.tolerance;
  }
  sink(json_text(all) + "\n");
}

} // namespace cowgpu
