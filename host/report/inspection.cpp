#include "host/report/inspection.hpp"

#include "host/mesh/topology.hpp"
#include "host/report/json_parts.hpp"
#include "host/report/result.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace cowgpu {
namespace {

using Json = nlohmann::ordered_json;

Json place_json(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

Vec3 middle(const FacePair& pair) {
  return pair.how.from / 2 + pair.how.to / 2;
}

/// The first pairs to be named: those that are more than touching before the others.
std::vector<const FacePair*> first_pairs(const SelfIntersections& found) {
  std::vector<const FacePair*> first;
  for (const bool touching : {false, true})
    for (const FacePair& pair : found.pairs)
      if (first.size() < listed_pairs && (pair.how.meeting == Meeting::touching) == touching) first.push_back(&pair);
  return first;
}

Json json_of(const RawMesh& mesh, const SelfIntersections& found) {
  Json listed = Json::array();
  for (const FacePair* pair : first_pairs(found)) {
    Json one = {{"faces", {pair->first, pair->second}},
                {"kind", name(pair->how.meeting)},
                {"place", place_json(middle(*pair))}};
    if (!mesh.face_lines.empty()) one["lines"] = {mesh.face_lines[pair->first], mesh.face_lines[pair->second]};
    listed.push_back(one);
  }
  return {{"crossing", found.crossing}, {"overlapping", found.overlapping}, {"touching", found.touching},
          {"faces", found.faces},       {"complete", found.complete},       {"listed", listed}};
}

Json json_of(const RegionVolume& region, double volume) {
  return {{"volume", region.volume}, {"uncertainty", region.uncertainty}, {"fraction", region.volume / volume}};
}

std::string text_of(const RegionVolume& region, double volume) {
  if (region.volume == 0) return "none";
  return fmt::format("{:.6g} +- {:.1g}, {:.4g} % of the volume", region.volume, region.uncertainty,
                     100 * region.volume / volume);
}

} // namespace

nlohmann::ordered_json inspection_json(const Inspection& found, const std::string& output) {
  const Audit& a = found.audit;
  const RawMesh& mesh = found.mesh;
  Json out = {{"schema", "cowgpu.inspect.v1"},
              {"name", mesh.name},
              {"sha256", mesh.sha256},
              {"vertices", a.vertices},
              {"faces", a.faces},
              {"edges", a.edges},
              {"moments", found.moments},
              {"maps", found.maps},
              {"finite", a.finite},
              {"closed", a.closed},
              {"edge_manifold", a.edge_manifold},
              {"vertex_manifold", a.vertex_manifold},
              {"consistently_oriented", a.consistently_oriented},
              {"outward", a.outward},
              {"components", a.components},
              {"cavities", a.cavities},
              {"euler_characteristic", a.euler_characteristic},
              {"open_edges", a.open_edges},
              {"unbalanced_edges", a.unbalanced_edges},
              {"crowded_edges", a.crowded_edges},
              {"pinched_vertices", a.pinched_vertices},
              {"unused_vertices", a.unused_vertices},
              {"degenerate_faces", a.degenerate_faces},
              {"duplicate_faces", a.duplicate_faces},
              {"coincident_groups", a.coincident_groups}};
  if (a.genus) out["genus"] = *a.genus;
  if (a.finite) {
    out["area"] = a.area;
    out["bounding_box"] = {place_json(a.box.min), place_json(a.box.max)};
    out["shortest_edge"] = a.shortest_edge;
    out["longest_edge"] = a.longest_edge;
  }
  if (found.intersections) out["self_intersections"] = json_of(mesh, *found.intersections);
  if (a.volume) out["volume"] = *a.volume;
  if (found.overlap) {
    out["overlapped"] = json_of(found.overlap->overlapped, *a.volume);
    out["inverted"] = json_of(found.overlap->inverted, *a.volume);
  }
  if (a.centre_of_mass) out["centre_of_mass"] = place_json(*a.centre_of_mass);
  if (found.brillouin_radius) {
    out["brillouin_radius"] = *found.brillouin_radius;
    out["inscribed_radius"] = found.inscribed_radius ? Json(*found.inscribed_radius) : Json();
  }
  if (found.largest_ball)
    out["largest_ball"] = {{"centre", place_json(found.largest_ball->centre)},
                           {"radius", found.largest_ball->radius},
                           {"bound", found.largest_ball->bound}};
  out["notes"] = mesh.notes;
  if (!output.empty()) out["output"] = output;
  return out;
}

void write_inspection(const Inspection& found, const Sink& sink) {
  const Audit& a = found.audit;
  const RawMesh& mesh = found.mesh;
  const auto row = [&](const char* what, const std::string& value) { sink(fmt::format("  {:<24} {}\n", what, value)); };
  const auto yes = [](bool value) { return std::string(value ? "yes" : "no"); };
  const auto point = [](const Vec3& v) { return fmt::format("({:.15g}, {:.15g}, {:.15g})", v.x(), v.y(), v.z()); };
  sink(mesh_line(mesh) + "\n");
  for (const std::string& note : mesh.notes) sink("note: " + note + "\n");
  row("fit for moments", found.moments);
  row("fit for sphere maps", found.maps);
  row("vertices, edges, faces", fmt::format("{}, {}, {}", a.vertices, a.edges, a.faces));
  row("coordinates finite", yes(a.finite));
  row("closed", a.closed ? "yes" : fmt::format("no: {} open edges", a.open_edges));
  row("oriented", a.consistently_oriented ? "yes" : fmt::format("no: {} unbalanced edges", a.unbalanced_edges));
  row("edge-manifold", a.edge_manifold ? "yes" : fmt::format("no: {} edges with more than two faces", a.crowded_edges));
  row("vertex-manifold", a.vertex_manifold ? "yes" : fmt::format("no: {} pinched vertices", a.pinched_vertices));
  row("outward", yes(a.outward));
  row("shells, cavities", fmt::format("{}, {}", a.components, a.cavities));
  row("Euler characteristic",
      fmt::format("{}{}", a.euler_characteristic, a.genus ? fmt::format(", genus {}", *a.genus) : ""));
  row("degenerate, duplicate", fmt::format("{}, {} faces", a.degenerate_faces, a.duplicate_faces));
  row("unused, coincident", fmt::format("{} vertices, {} places", a.unused_vertices, a.coincident_groups));
  if (const auto& met = found.intersections) {
    row("self-intersections", met->pairs.empty() ? "none"
                                                 : fmt::format("{}{} pairs of faces cross, {} overlap, {} touch",
                                                               met->complete ? "" : "at least ", met->crossing,
                                                               met->overlapping, met->touching));
    for (const FacePair* pair : first_pairs(*met))
      row("", fmt::format("{}: {} and {} near {}", name(pair->how.meeting), where(mesh, pair->first),
                          where(mesh, pair->second), point(middle(*pair))));
    if (met->pairs.size() > listed_pairs) row("", fmt::format("and {} more", met->pairs.size() - listed_pairs));
  }
  if (a.finite) {
    row("bounding box", point(a.box.min) + " to " + point(a.box.max));
    row("area", fmt::format("{:.15g}", a.area));
    row("edge lengths", fmt::format("{:.6g} to {:.6g}", a.shortest_edge, a.longest_edge));
  }
  if (a.volume) row("volume", fmt::format("{:.15g}", *a.volume));
  if (found.overlap) {
    row("overlapped volume", text_of(found.overlap->overlapped, *a.volume));
    row("volume inside out", text_of(found.overlap->inverted, *a.volume));
  }
  if (a.centre_of_mass) row("centre of mass", point(*a.centre_of_mass));
  if (found.brillouin_radius) {
    row("Brillouin radius", fmt::format("{:.15g} about the centre of mass", *found.brillouin_radius));
    row("inscribed radius", found.inscribed_radius
                                ? fmt::format("{:.15g} about the centre of mass", *found.inscribed_radius)
                                : "none: the centre of mass lies outside the body");
  }
  if (const auto& ball = found.largest_ball)
    row("largest ball inside",
        fmt::format("radius {:.6g} about {} (none above {:.6g})", ball->radius, point(ball->centre), ball->bound));
}

} // namespace cowgpu
