#include "host/coefficient_set.hpp"
#include "host/io/number.hpp"
#include "host/report/json_parts.hpp"
#include "host/report/result.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>

namespace cowgpu {
namespace {

using nlohmann::ordered_json;

ordered_json json_of(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

ordered_json json_of(const Eigen::Matrix3d& m) {
  ordered_json rows = ordered_json::array();
  for (int row = 0; row < 3; ++row) rows.push_back({m(row, 0), m(row, 1), m(row, 2)});
  return rows;
}

ordered_json json_of(const Part& part) {
  const RawMesh& mesh = part.surface.mesh();
  return {{"name", mesh.name},
          {"sha256", mesh.sha256},
          {"vertices", mesh.vertices.size()},
          {"faces", mesh.faces.size()},
          {"density", part.density},
          {"volume", part.volume},
          {"mass", part.mass()},
          {"centre_of_mass", json_of(part.centre_of_mass)}};
}

ordered_json json_of(const Body& body) {
  const RawMesh& mesh = body.surface.mesh();
  ordered_json json = {{"name", mesh.name},
                       {"sha256", mesh.sha256},
                       {"vertices", mesh.vertices.size()},
                       {"faces", mesh.faces.size()},
                       {"volume", body.volume},
                       {"area", body.area},
                       {"mass", body.mass()},
                       {"centre_of_mass", json_of(body.centre_of_mass)}, // nulls where the parts' masses cancel
                       {"bounding_box", {json_of(body.box.min), json_of(body.box.max)}},
                       {"brillouin_radius", body.brillouin_radius},
                       {"placement", {{"metres_per_unit", nullptr}, {"rotation", json_of(body.placement.rotation)}}}};
  if (body.units().stated) json["placement"]["metres_per_unit"] = body.units().metre;
  ordered_json parts = ordered_json::array();
  for (const Part& part : body.parts) parts.push_back(json_of(part));
  json["parts"] = parts;
  return json;
}

ordered_json json_of(const Timings& t, const RunReport& run) {
  ordered_json kernels = ordered_json::array();
  for (const KernelTime& k : run.kernels)
    kernels.push_back({{"kernel", k.kernel}, {"dispatches", k.dispatches}, {"seconds", k.seconds}});
  return {{"load", t.load},         {"device", t.device}, {"moments", t.moments}, {"verify", t.verify},
          {"surfaces", t.surfaces}, {"total", t.total},   {"kernels", kernels}};
}

ordered_json json_of(const Accuracy& accuracy) {
  constexpr std::array how = {"none", "sample", "full"};
  ordered_json agreements = ordered_json::array();
  for (const Agreement& a : accuracy.agreements)
    agreements.push_back({{"path", a.path},
                          {"against", a.against},
                          {"worst", a.errors.relative()},
                          {"worst_degree", a.errors.degree},
                          {"weighed", a.errors.ratio}});
  ordered_json json = {{"verify", how[std::size_t(accuracy.how)]},
                       {"triangles", accuracy.triangles},
                       {"seed", accuracy.seed},
                       {"bound", nullptr},
                       {"worst", nullptr},
                       {"passed", nullptr},
                       {"agreements", agreements}};
  if (const Agreement* worst = accuracy.worst()) { // an unchecked result must not look like a checked one
    json["bound"] = Accuracy::bound;
    json["worst"] = worst->errors.ratio;
    json["passed"] = accuracy.passed();
    const WorstDegree known = worst_known_degree(accuracy.estimate);
    json["estimate"] = {{"sentences", sentences(accuracy.estimate)},
                        {"relative", nullptr},
                        {"worst_degree", nullptr},
                        {"error", accuracy.estimate.error},
                        {"norm", accuracy.estimate.norm},
                        {"bound", accuracy.estimate.bound}};
    if (known.degree >= 0) {
      json["estimate"]["relative"] = known.relative;
      json["estimate"]["worst_degree"] = known.degree;
    }
  }
  return json;
}

// The coefficients do not fit a document in memory at high degree: one row a line, written as they come.
void write_coefficients(const Multipoles& q, const Sink& sink) {
  std::string text;
  for (int l = 0; l <= q.lmax; ++l)
    for (int m = 0; m <= l; ++m) {
      text += l == 0 ? "\n[" : ",\n[";
      text += std::to_string(l) + ", " + std::to_string(m) + ", ";
      append_number(text, q(l, m).real());
      text += ", ";
      append_number(text, q(l, m).imag());
      text += "]";
      if (text.size() > 65536) {
        sink(text);
        text.clear();
      }
    }
  sink(text);
}

void write_mass(const ExpandResult& result, const Sink& sink) {
  const bool metric = result.body.units().stated;
  const ordered_json mass = {
      {"lmax", result.mass.lmax},
      {"origin", json_of(result.mass.origin)},
      {"origin_kind", result.body.origin_kind},
      {"reference_radius", result.mass.reference_radius},
      {"brillouin_radius", result.body.brillouin_radius},
      {"normalisation", "orthonormal"},
      {"condon_shortley", true},
      {"conjugated", false},
      {"axes", "the mesh's; theta from +z, phi from +x towards +y"},
      {"units", std::string(metric ? "kg, lengths in metres" : "density * length^3, in the mesh's length unit") +
                    "; Q_lm = value * reference_radius^l"},
      {"density", result.mass.density},
      {"cut_off", result.cut_off}};
  sink(fmt::format("\"{}\": ", mass_expansion) + json_members(mass) + ",\n \"coefficients\": [");
  write_coefficients(result.mass, sink);
  sink("\n]}");
}

} // namespace

std::uint64_t json_bytes(int lmax) {
  return 4096 + 80 * std::uint64_t(lmax) + 61 * std::uint64_t(Multipoles::count(lmax));
}

void write_json(const ExpandResult& result, const Sink& sink) {
  const ordered_json head = {
      {"schema", "cowgpu.result.v1"},
      {"program", program_json()},
      {"command", result.command},
      {"created", result.created},
      {"mesh", json_of(result.body)},
      {"device", device_json(result.device)},
      {"notes", result.notes},
      {"tensors",
       {{"origin", json_of(result.body.origin)},
        {"units", result.body.units().stated ? "kg m^2" : "density * length^5, in the mesh's length unit"},
        {"quadrupole", json_of(result.tensors.quadrupole)},
        {"inertia", json_of(result.tensors.inertia)},
        {"second_moment", json_of(result.tensors.second_moment)}}},
      {"timings", json_of(result.timings, result.run)},
      {"accuracy", json_of(result.accuracy)}};
  sink(json_members(head) + ",\n \"expansions\": {");
  if (result.has_mass) write_mass(result, sink);
  bool first = !result.has_mass;
  for (const SurfaceResult& surface : result.surfaces) {
    sink(fmt::format("{}\"{}\": ", first ? "" : ",\n ", name(surface.of)));
    write_surface_json(surface, sink);
    first = false;
  }
  sink("}\n}\n");
}

} // namespace cowgpu
