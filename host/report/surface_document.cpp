#include "host/report/surface_result.hpp"

#include "host/paper/surface_tables.hpp"
#include "host/report/document_parts.hpp"

#include <fmt/format.h>

namespace cowgpu {
namespace {

Object map_members(const SurfaceResult& result) {
  const MapQuality& quality = result.quality;
  Object map = {{"method", name(result.map.method)}};
  if (!result.map_file.empty()) map.add({{"file", result.map_file}, {"sha256", result.map_sha256}});
  map.add({{"lookup", lookup_name(result)},
           {"flipped", quality.flipped.size()},
           {"flipped_area", quality.flipped_area},
           {"flat", quality.flat.size()},
           {"degree", quality.degree},
           {"inside_out", quality.inside_out},
           {"distortion", Object{{"log_area_ratio", quantiles(log_area_ratio_parts, quality.log_area_ratio)},
                                 {"shear", quantiles(shear_parts, quality.shear)}}},
           {"unseen", quality.unseen},
           {"unseen_area", quality.unseen_area},
           {"notes", result.map.notes}});
  return map;
}

Object paper_members(const SurfaceResult& result) {
  List rows;
  for (const PaperRow& row : paper_table(result)) {
    List line = {row.l, row.m};
    for (const std::complex<double>& value : row.values) {
      line.push_back(value.real());
      line.push_back(value.imag());
    }
    rows.push_back(std::move(line));
  }
  const auto within = converged_within(result);
  return {{"fields", List{"f_r", "f_dtheta", "f_dphi"}},
          {"coefficients", rows},
          {"misfits", paper_misfits(result.expansion, paper_table(result))},
          {"distances", paper_distances(converged_expansion(result), paper_table(result))},
          {"converged_within", Numbers{within[0], within[1], within[2]}}};
}

} // namespace

std::uint64_t surface_json_bytes(int lmax) {
  return 4096 + 270 * std::uint64_t(SphereCoefficients::count(lmax));
}

Object members(const SurfaceResult& result) {
  const SurfaceExpansion& expansion = result.expansion;
  const SphereCoefficients& a = expansion.coefficients;
  Object all = {{"lmax", a.lmax},
                {"origin", expansion.origin},
                {"origin_kind", result.origin_kind},
                {"recipe", result.recipe},
                {"fields", surface_field_names},
                {"removed_means", Object{{"f_dtheta", expansion.mean_dtheta}, {"f_dphi", expansion.mean_dphi}}},
                {"normalisation", "orthonormal"},
                {"condon_shortley", true},
                {"axes", "the mesh's; theta from +z, phi from +x towards +y"},
                {"units", fmt::format("f_r, x, y, z in {}, f_dtheta and f_dphi in radians; x, y, z in mesh coordinates",
                                      result.length_unit)},
                {"dphi", expansion.signed_dphi ? "signed" : "absolute"},
                {"map", map_members(result)},
                {"grid", Object{{"kind", "gl"},
                                {"rings", result.report.rings},
                                {"ring_length", result.report.ring_length},
                                {"exact_decisions", result.report.exact_decisions}}},
                {"aliasing", result.report.aliasing},
                {"truncation", result.report.truncation},
                {"timings", Object{{"map", result.map_seconds},
                                   {"sample", result.report.sample_seconds},
                                   {"analyse", result.report.analyse_seconds}}}};
  if (result.flow) all.add("flow", members(*result.flow));
  if (result.beside_paper) all.add("paper", paper_members(result));
  all.add("coefficients", CoefficientRows{a.lmax, [&a](int l, int m, Numbers& row) {
                                            for (int f = 0; f < a.fields; ++f) {
                                              row.push_back(a.at(f, l, m).real());
                                              row.push_back(a.at(f, l, m).imag());
                                            }
                                          }});
  return all;
}

} // namespace cowgpu
