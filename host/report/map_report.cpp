#include "host/report/map_report.hpp"

#include "host/mesh/topology.hpp"
#include "host/report/document_parts.hpp"
#include "host/report/flow_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace cowgpu {
namespace {

constexpr std::size_t listed_faces = 5;

std::string count_text(const RawMesh& mesh, const std::vector<std::uint32_t>& faces) {
  std::string text = fmt::format("{}", faces.size());
  for (std::size_t i = 0; i < std::min(faces.size(), listed_faces); ++i)
    text += (i == 0 ? ": " : "; ") + where(mesh, faces[i]);
  return faces.size() > listed_faces ? text + "; ..." : text;
}

std::string quantiles_text(std::span<const double> parts, std::span<const double> values, bool powers_of_ten) {
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i) { // + 0.0: no minus before zero
    const std::string value = powers_of_ten ? fmt::format("10^{:.2f}", std::round(100 * values[i]) / 100 + 0.0)
                                            : fmt::format("{:.4g}", values[i]);
    text += fmt::format("{}{} ({} %)", i == 0 ? "" : ", ", value, 100 * parts[i]);
  }
  return text;
}

struct Repeats {
  std::size_t reached = 0;
  double energy = 0, largest = 0, rms = 0; // the worst: relative; of those that reach the map's energy
};

Repeats summary(const MapResult& result) {
  Repeats all;
  for (const StretchRepeat& repeat : result.repeats) {
    if (!repeat.reached) continue;
    ++all.reached;
    all.energy = std::max(all.energy, std::abs(repeat.energy / result.stretch->energy - 1));
    all.largest = std::max(all.largest, repeat.largest);
    all.rms = std::max(all.rms, repeat.rms);
  }
  return all;
}

std::string repeats_text(const MapResult& result) {
  const Repeats all = summary(result);
  std::string text =
      fmt::format("{} of {} copies reach this mean square to {:.0e}", all.reached, result.repeats.size(), same_minimum);
  if (all.reached > 0)
    text += fmt::format(" (to {:.1e}, positions to {:.1e}, root mean square {:.1e})", all.energy, all.largest, all.rms);
  return text + fmt::format(", in {:.3f} s", result.repeat_seconds);
}

Value stretch(const MapResult& result) {
  if (!result.stretch) return {};
  List copies;
  for (const StretchRepeat& r : result.repeats)
    copies.push_back(
        Object{{"seed", r.seed}, {"energy", r.energy}, {"largest", r.largest}, {"rms", r.rms}, {"reached", r.reached}});
  return Object{{"energy", result.stretch->energy},
                {"gradient", result.stretch->gradient},
                {"relabellings",
                 Object{{"count", result.repeats.size()}, {"reached", summary(result).reached}, {"copies", copies}}}};
}

Object members(const MapQuality& q) {
  List parts;
  for (const UnseenPart& part : q.parts)
    parts.push_back(Object{{"triangles", part.triangles}, {"area", part.area}, {"middle", part.middle}});
  return {
      {"lmax", q.lmax},
      {"cell", q.cell},
      {"triangles", q.triangles},
      {"degree", q.degree},
      {"inside_out", q.inside_out},
      {"flipped", Object{{"count", q.flipped.size()}, {"area", q.flipped_area}, {"faces", q.flipped}}},
      {"flat", Object{{"count", q.flat.size()}, {"faces", q.flat}}},
      {"log_area_ratio", quantiles(log_area_ratio_parts, q.log_area_ratio)},
      {"shear", quantiles(shear_parts, q.shear)},
      {"smallest_area", Object{{"steradians", q.smallest_area}, {"face", q.smallest_area_face}}},
      {"smallest_height",
       Object{{"radians", q.smallest_height}, {"cells", q.smallest_height / q.cell}, {"face", q.smallest_height_face}}},
      {"seen", q.triangles - q.unseen},
      {"unseen", Object{{"count", q.unseen}, {"area", q.unseen_area}, {"parts", parts}}},
      {"sentences", q.sentences}};
}

} // namespace

void write_screen(const MapResult& result, const Sink& sink) {
  const auto row = [&](const char* what, const std::string& value) { sink(fmt::format("  {:<24} {}\n", what, value)); };
  const MapQuality& q = result.quality;
  const RawMesh& mesh = result.surface.closed().mesh();
  sink(mesh_line(mesh) + "\n");
  for (const std::string& note : result.notes) sink("note: " + note + "\n");
  sink(fmt::format("map: {}, made in {:.3f} s, judged in {:.3f} s\n", name(result.map.method), result.map_seconds,
                   result.judge_seconds));
  for (const std::string& note : result.map.notes) sink("note: " + note + "\n");
  if (result.flow) {
    sink(fmt::format("flow: for T = {:.9g} ({}), {}\n", result.flow->time,
                     result.flow->time_choice == "auto" ? "the least time that is star-shaped" : "given",
                     flow_points_text(result.flow->points)));
    sink("flow: " + star_shape_text(result.flow->star) + "\n");
    sink("flow: " + star_shape_sentence(result.flow->star, result.flow->time) + "\n");
  }
  sink(fmt::format("judged against a grid for lmax {}, whose cells are {:.3g} degrees ({:.3e} rad) high:\n", q.lmax,
                   q.cell * 180 / std::numbers::pi, q.cell));
  row("flipped triangles", count_text(mesh, q.flipped));
  row("triangles of no area", count_text(mesh, q.flat));
  row("area on sphere / body", quantiles_text(log_area_ratio_parts, q.log_area_ratio, true) + " of the surface");
  row("shear", quantiles_text(shear_parts, q.shear, false) + " of the surface");
  row("smallest triangle", fmt::format("{:.3e} sr, {:.3g} of a square cell, {}", q.smallest_area,
                                       q.smallest_area / (q.cell * q.cell), where(mesh, q.smallest_area_face)));
  row("smallest height", fmt::format("{:.3e} rad, {:.3g} of a cell, {}", q.smallest_height, q.smallest_height / q.cell,
                                     where(mesh, q.smallest_height_face)));
  if (result.stretch)
    row("stretch",
        fmt::format("mean square {:.9g} (an isometry tends to 1 as triangles shrink, and is above it on coarse "
                    "ones), gradient {:.1e}",
                    result.stretch->energy, result.stretch->gradient));
  if (!result.repeats.empty()) row("relabelled and turned", repeats_text(result));
  row("seen by the grid", fmt::format("{} of {} triangles, {:.6g} % of the surface", q.triangles - q.unseen,
                                      q.triangles, 100 * (1 - q.unseen_area)));
  sink("in words:\n");
  for (const std::string& sentence : q.sentences) sink("  " + sentence + ".\n");
}

Object document(const MapResult& result, const std::vector<std::string>& command) {
  std::vector<std::string> notes = result.notes;
  notes.insert(notes.end(), result.map.notes.begin(), result.map.notes.end());
  Object all = opening("cowgpu.map.v1", command);
  all.add({{"mesh", members(result.surface.closed().mesh())},
           {"method", name(result.map.method)},
           {"notes", notes},
           {"output", known_text(result.output)},
           {"quality", members(result.quality)},
           {"stretch", stretch(result)},
           {"timings", Object{{"map", result.map_seconds},
                              {"judge", result.judge_seconds},
                              {"relabellings", result.repeat_seconds}}}});
  if (result.flow) {
    const FlowMapReport& flow = *result.flow;
    all.add("flow", Object{{"time", flow.time},
                           {"time_choice", flow.time_choice},
                           {"origin", flow.origin},
                           {"star_shape", members(flow.star)},
                           {"points", members(flow.points)}});
  }
  return all;
}

} // namespace cowgpu
