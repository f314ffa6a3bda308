#include "host/report/surface_result.hpp"

#include "host/io/number.hpp"
#include "host/paper/surface_tables.hpp"
#include "host/report/json_parts.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace cowgpu {
namespace {

using nlohmann::ordered_json;

ordered_json map_json(const SurfaceResult& result) {
  const MapQuality& quality = result.quality;
  ordered_json map = {{"method", name(result.map.method)}};
  if (!result.map_file.empty()) {
    map["file"] = result.map_file;
    map["sha256"] = result.map_sha256;
  }
  const ordered_json worth = {{"lookup", lookup_name(result)},
                              {"flipped", quality.flipped.size()},
                              {"flipped_area", quality.flipped_area},
                              {"flat", quality.flat.size()},
                              {"degree", quality.degree},
                              {"inside_out", quality.inside_out},
                              {"distortion",
                               {{"log_area_ratio", quantiles_json(log_area_ratio_parts, quality.log_area_ratio)},
                                {"shear", quantiles_json(shear_parts, quality.shear)}}},
                              {"unseen", quality.unseen},
                              {"unseen_area", quality.unseen_area},
                              {"notes", result.map.notes}};
  map.update(worth);
  return map;
}

ordered_json rows_json(const std::vector<std::array<double, 6>>& degrees) {
  ordered_json rows = ordered_json::array();
  for (const auto& row : degrees) rows.push_back(row);
  return rows;
}

ordered_json paper_json(const SurfaceResult& result) {
  ordered_json rows = ordered_json::array();
  for (const PaperRow& row : paper_table(result)) {
    ordered_json line = {row.l, row.m};
    for (const std::complex<double>& value : row.values) {
      line.push_back(value.real());
      line.push_back(value.imag());
    }
    rows.push_back(std::move(line));
  }
  const auto within = converged_within(result);
  return {{"fields", {"f_r", "f_dtheta", "f_dphi"}},
          {"coefficients", rows},
          {"misfits", paper_misfits(result.expansion, paper_table(result))},
          {"distances", paper_distances(converged_expansion(result), paper_table(result))},
          {"converged_within", {within[0], within[1], within[2]}}};
}

} // namespace

std::uint64_t surface_json_bytes(int lmax) {
  return 4096 + 270 * std::uint64_t(SphereCoefficients::count(lmax));
}

void write_surface_json(const SurfaceResult& result, const std::function<void(std::string_view)>& sink) {
  const SurfaceExpansion& expansion = result.expansion;
  const SphereCoefficients& a = expansion.coefficients;
  const Vec3& o = expansion.origin;
  ordered_json head = {
      {"lmax", a.lmax},
      {"origin", {o.x(), o.y(), o.z()}},
      {"origin_kind", result.origin_kind},
      {"recipe", result.recipe},
      {"fields", surface_field_names},
      {"removed_means", {{"f_dtheta", expansion.mean_dtheta}, {"f_dphi", expansion.mean_dphi}}},
      {"normalisation", "orthonormal"},
      {"condon_shortley", true},
      {"axes", "the mesh's; theta from +z, phi from +x towards +y"},
      {"units", fmt::format("f_r, x, y, z in {}, f_dtheta and f_dphi in radians; x, y, z in mesh coordinates",
                            result.length_unit)},
      {"dphi", expansion.signed_dphi ? "signed" : "absolute"},
      {"map", map_json(result)},
      {"grid",
       {{"kind", "gl"},
        {"rings", result.report.rings},
        {"ring_length", result.report.ring_length},
        {"exact_decisions", result.report.exact_decisions}}},
      {"aliasing", rows_json(result.report.aliasing)},
      {"truncation", rows_json(result.report.truncation)},
      {"timings",
       {{"map", result.map_seconds},
        {"sample", result.report.sample_seconds},
        {"analyse", result.report.analyse_seconds}}}};
  if (result.flow) head["flow"] = flow_json(*result.flow);
  if (result.beside_paper) head["paper"] = paper_json(result);
  sink(json_members(head) + ",\n \"coefficients\": [");
  std::string text;
  for (int l = 0; l <= a.lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      text += l == 0 ? "\n[" : ",\n[";
      text += std::to_string(l) + ", " + std::to_string(m);
      for (int f = 0; f < a.fields; ++f)
        for (const double part : {a.at(f, l, m).real(), a.at(f, l, m).imag()}) {
          text += ", ";
          append_number(text, part);
        }
      text += "]";
      if (text.size() > 65536) {
        sink(text);
        text.clear();
      }
    }
  sink(text + "\n]}");
}

} // namespace cowgpu
