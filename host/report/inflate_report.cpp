#include "host/report/inflate_report.hpp"

#include "host/report/document_parts.hpp"
#include "host/report/flow_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

std::vector<std::string> all_notes(const InflateResult& result) {
  std::vector<std::string> notes = result.notes;
  for (const InflatedBody& body : result.bodies)
    if (!body.note.empty()) notes.push_back(body.note);
  return notes;
}

Object members(const InflatedBody& body) {
  const Audit& a = body.audit;
  return {{"level", body.level},
          {"name", body.name},
          {"volume", a.volume},
          {"area", a.area},
          {"volume_error", body.error.volume_error},
          {"area_error", body.error.area_error},
          {"vertices", a.vertices},
          {"faces", a.faces},
          {"shells", a.components},
          {"genus", a.genus},
          {"closed", a.closed},
          {"cell", body.report.cell},
          {"queries", body.report.queries},
          {"largest_residual", body.report.largest_residual},
          {"output", known_text(body.output)},
          {"seconds", body.report.seconds}};
}

// A value with its error, and no digits beyond that.
std::string text_of(double value, double error) {
  const double parts = std::abs(value) / error;
  const int digits = std::isfinite(parts) && parts > 0 ? std::clamp(int(std::ceil(std::log10(parts))) + 1, 1, 8) : 8;
  return fmt::format("{:.{}g} +- {:.1e}", value, digits, error);
}

} // namespace

Object document(const InflateResult& result, const std::vector<std::string>& command) {
  const Body& body = result.body;
  Object mesh = members(body.surface.mesh());
  mesh.add({{"volume", body.volume}, {"area", body.area}});
  List levels;
  for (const InflatedBody& inflated : result.bodies) levels.push_back(members(inflated));
  Object all = opening("cowgpu.inflate.v1", command);
  all.add({{"mesh", mesh},
           {"origin", body.origin},
           {"origin_kind", body.origin_kind},
           {"device", members(result.device)},
           {"notes", all_notes(result)},
           {"star_shape", result.star ? Value(members(*result.star)) : Value()},
           {"levels", levels},
           {"picture", known_text(result.picture)},
           {"timings", Object{{"star_shape", result.star_seconds}}}});
  return all;
}

void write_inflate(const InflateResult& result, const Sink& sink) {
  const Vec3& o = result.body.origin;
  sink(mesh_line(result.body.surface.mesh()) + "\n");
  for (const std::string& note : all_notes(result)) sink("note: " + note + "\n");
  sink("device: " + device_line(result.device) + "\n");
  if (result.star)
    sink(fmt::format("{}; origin ({:.9g}, {:.9g}, {:.9g}) ({}), {} closest points, {:.3f} s\n",
                     star_shape_text(*result.star), o.x(), o.y(), o.z(), result.body.origin_kind, result.star->queries,
                     result.star_seconds));
  if (result.bodies.empty()) return;
  sink("the body inflated by a distance, in the mesh's length unit\n");
  sink(fmt::format("  {:>10}  {:>20}  {:>20}  {:>6}  {:>5}  {:>9}  {:>9}  {:>8}\n", "level", "volume", "area", "shells",
                   "genus", "triangles", "cell", "seconds"));
  for (const InflatedBody& b : result.bodies)
    sink(fmt::format("  {:>10.6g}  {:>20}  {:>20}  {:>6}  {:>5}  {:>9}  {:>9.3g}  {:>8.3f}\n", b.level,
                     text_of(b.audit.volume.value_or(std::nan("")), b.error.volume_error),
                     text_of(b.audit.area, b.error.area_error), b.audit.components,
                     b.audit.genus ? fmt::format("{}", *b.audit.genus) : "-", b.audit.faces, b.report.cell,
                     b.report.seconds));
}

} // namespace cowgpu
