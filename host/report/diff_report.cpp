#include "host/report/diff_report.hpp"

#include "host/io/coefficient_metadata.hpp"
#include "host/report/document_parts.hpp"

#include <fmt/format.h>

namespace cowgpu {
namespace {

Object members(const FieldDifference& field) {
  List degrees;
  for (std::size_t l = 0; l < field.norm.size(); ++l)
    degrees.push_back(Object{{"l", l},
                             {"norm", field.norm[l]},
                             {"difference", field.difference[l]},
                             {"relative", field.relative(l)},
                             {"worst_m", field.worst_order[l]}});
  return {{"name", field.name},        {"norm", field.total_norm},
          {"difference", field.total}, {"relative", field.total_relative()},
          {"worst", field.worst},      {"worst_degree", field.worst_degree},
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

Object document(const DiffResult& found) {
  const CoefficientDifference& result = found.difference;
  List fields;
  for (const FieldDifference& field : result.fields) fields.push_back(members(field));
  Object all = opening("cowgpu.diff.v1", found.command, found.created);
  all.add({{"first", found.first},
           {"second", found.second},
           {"notes", found.notes},
           {"kind", name(result.kind)},
           {"normalisation", name(result.convention.normalisation)},
           {"phase", name(result.convention.phase)},
           {"reference_radius", result.reference_radius > 0 ? Value(result.reference_radius) : Value()},
           {"lmax", result.lmax},
           {"unlike", result.unlike},
           {"fields", fields},
           {"worst", result.worst()},
           {"tolerance", found.tolerance},
           {"passed", found.tolerance ? Value(result.worst() <= *found.tolerance) : Value()}});
  return all;
}

} // namespace cowgpu
