#include "host/mesh/closed_surface.hpp"

#include "host/counted.hpp"
#include "host/error.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/mend_hint.hpp"
#include "host/mesh/topology.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

constexpr std::size_t named = 5; // offenders named in a message
// Fifth powers of lengths (moments of inertia, l = 2) times a density must stay within double's 1e-308 to 1e308.
constexpr double largest_coordinate = 1e50, smallest_extent = 1e-50;

/// Counts offenders and keeps the first few for the message.
class Offenders {
public:
  void add(const auto& describe) {
    if (count_++ < named) text_ += (text_.empty() ? "" : "; ") + std::string(describe());
  }
  bool any() const { return count_ != 0; }
  std::size_t count() const { return count_; }
  /// "3 edges are ...", by the number.
  std::string number(const char* one, const char* many) const {
    return fmt::format("{} {}", count_, count_ == 1 ? one : many);
  }
  /// "vertex 1 - vertex 2 (face 3); ...", the first of them.
  std::string list() const { return (count_ > named ? "the first are " : "") + text_; }

private:
  std::size_t count_ = 0;
  std::string text_;
};

[[noreturn]] void fail(Fault fault, const RawMesh& mesh, const std::string& sentence) {
  throw Error(fault, fmt::format("{}: {}", called(mesh), sentence));
}

std::string shown(const RawMesh& mesh, const EdgeUse& use) {
  return fmt::format("vertex {} - vertex {} ({})", use.forward ? use.low : use.high, use.forward ? use.high : use.low,
                     where(mesh, use.face));
}

void require_some(const RawMesh& mesh) {
  if (!mesh.vertices.empty() && !mesh.faces.empty()) return;
  std::string notes; // notes of the reader: perhaps all faces were left out
  for (const std::string& note : mesh.notes) notes += fmt::format(" ({})", note);
  fail(Fault::mesh_empty, mesh,
       fmt::format("the mesh has {} and {}; there is nothing to compute. Export the surface with its faces.{}",
                   counted(mesh.vertices.size(), "vertex", "vertices"), counted(mesh.faces.size(), "face", "faces"),
                   notes));
}

void require_finite(const RawMesh& mesh) {
  Offenders bad;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3& p = mesh.vertices[i];
    if (!p.allFinite()) bad.add([&] { return fmt::format("vertex {} ({}, {}, {})", i, p.x(), p.y(), p.z()); });
  }
  if (bad.any())
    fail(Fault::mesh_not_finite, mesh,
         fmt::format("{} no finite coordinates: {}. Repair or export the mesh again.",
                     bad.number("vertex has", "vertices have"), bad.list()));
}

void require_range(const RawMesh& mesh) {
  double largest = 0;
  for (const Vec3& p : mesh.vertices) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  const double extent = bounding_box(mesh.vertices, mesh.faces).longest_side();
  if (largest <= largest_coordinate && (extent == 0 || extent >= smallest_extent)) return;
  fail(Fault::mesh_range, mesh,
       fmt::format(
           "the largest |coordinate| is {} and the longest side of the bounding box {}; coordinates up to {} and "
           "boxes from {} keep powers of lengths within double precision. Choose another length unit.",
           largest, extent, largest_coordinate, smallest_extent));
}

std::string about_repeated(const RawMesh& mesh) {
  const std::string faces = repeated_faces(mesh);
  return faces.empty() ? "" : fmt::format(" There are duplicate faces, of the same corners: {}. Remove them.", faces);
}

void require_balance(const RawMesh& mesh) {
  Offenders open, unbalanced;
  for_each_edge(edge_uses(mesh.faces, mesh.vertices.size()), [&](std::span<const EdgeUse> edge) {
    const EdgeBalance sides = balance(edge);
    if (sides.balanced()) return;
    // The first use in the direction that is too frequent.
    const auto use = std::find_if(edge.begin(), edge.end(),
                                  [&](const EdgeUse& u) { return u.forward == (sides.forward > sides.backward); });
    if (edge.size() == 1)
      open.add([&] { return shown(mesh, *use); });
    else
      unbalanced.add([&] {
        return fmt::format("{}, {} times this way and {} back", shown(mesh, *use),
                           std::max(sides.forward, sides.backward), std::min(sides.forward, sides.backward));
      });
  });
  if (open.any()) {
    std::string sentence = fmt::format(
        "the surface is not closed: {} a face on one side only: {}. Fill the holes (vertices and faces count "
        "from 0; a seam of doubled vertices is a hole too and wants them merged).",
        open.number("edge has", "edges have"), open.list());
    if (unbalanced.any())
      sentence += fmt::format(" Besides, {} run more often in one direction than back.",
                              unbalanced.number("edge is", "edges are"));
    fail(Fault::mesh_open, mesh, sentence + about_repeated(mesh) + mend_hint(mesh));
  }
  if (unbalanced.any())
    fail(Fault::mesh_unbalanced, mesh,
         fmt::format(
             "{} run more often in one direction than back: {}. Orient the faces consistently: neighbours run "
             "their common edge in opposite directions; look for flipped, doubled or missing faces (vertices and "
             "faces count from 0).",
             unbalanced.number("edge is", "edges are"), unbalanced.list()) +
             about_repeated(mesh) + mend_hint(mesh));
}

void require_volume(const RawMesh& mesh) {
  const double size = volume(mesh.vertices, mesh.faces), noise = volume_noise(mesh.vertices, mesh.faces);
  if (size > noise) return;
  if (size < -noise)
    fail(Fault::mesh_inside_out, mesh,
         fmt::format(
             "the volume is {}: all faces look inwards, or more of them than outwards. Flip them (reverse the order "
             "of each face's corners), so that they run counter-clockwise seen from outside.",
             size) +
             mend_hint(mesh));
  fail(Fault::mesh_no_volume, mesh,
       fmt::format("the volume, {}, cannot be told from zero: rounding the coordinates alone can change it by {}. The "
                   "surface is flat, or its shells cancel; give it thickness.",
                   size, noise) +
           mend_hint(mesh));
}

void require_two_faces_per_edge(const RawMesh& mesh, std::span<const EdgeUse> uses) {
  Offenders degenerate, crowded;
  for (std::size_t face = 0; face < mesh.faces.size(); ++face)
    if (repeats_vertex(mesh.faces[face])) degenerate.add([&] { return where(mesh, face); });
  if (degenerate.any())
    fail(
        Fault::mesh_edge_manifold, mesh,
        fmt::format("{} a vertex twice (degenerate): {}. Maps need every edge between exactly two proper faces; remove "
                    "such faces.",
                    degenerate.number("face names", "faces name"), degenerate.list()));
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() != 2)
      crowded.add([&] { return fmt::format("{}, with {} faces", shown(mesh, edge[0]), edge.size()); });
  });
  if (crowded.any())
    fail(Fault::mesh_edge_manifold, mesh,
         fmt::format(
             "{} more than two faces: {}. Maps need exactly two; separate the sheets there by doubling the edge's "
             "vertices.",
             crowded.number("edge has", "edges have"), crowded.list()));
}

void require_one_fan_per_vertex(const RawMesh& mesh, std::span<const EdgeUse> uses) {
  Offenders pinched;
  for (const std::uint32_t vertex : vertices_with_several_fans(mesh.faces, uses, mesh.vertices.size()))
    pinched.add([&] { return fmt::format("vertex {}", vertex); });
  if (pinched.any())
    fail(Fault::mesh_vertex_manifold, mesh,
         fmt::format("{} where several sheets touch: {}. Maps need the faces round a vertex to form one fan; give each "
                     "sheet a vertex of its own.",
                     pinched.number("vertex is a point", "vertices are points"), pinched.list()));
}

} // namespace

ClosedSurface ClosedSurface::from(RawMesh mesh) {
  require_some(mesh);
  require_valid_indices(mesh);
  require_finite(mesh);
  require_range(mesh);
  require_balance(mesh);
  require_volume(mesh);
  if (const std::size_t unused = unused_vertices(mesh.faces, mesh.vertices.size()); unused != 0)
    mesh.notes.push_back(fmt::format("{} to no face.", counted(unused, "vertex belongs", "vertices belong")));
  return ClosedSurface(std::move(mesh));
}

ManifoldSurface ManifoldSurface::from(ClosedSurface surface) {
  const RawMesh& mesh = surface.mesh();
  const std::vector<EdgeUse> uses = edge_uses(mesh.faces, mesh.vertices.size());
  require_two_faces_per_edge(mesh, uses);
  require_one_fan_per_vertex(mesh, uses);
  return ManifoldSurface(std::move(surface));
}

} // namespace cowgpu
