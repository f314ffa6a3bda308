#include "host/mesh/mend.hpp"

#include "host/error.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/self_intersections.hpp"
#include "host/mesh/topology.hpp"
#include "host/mesh/weld.hpp"
#include "host/mesh/winding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace cowgpu {
namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

void require_two_faces_at_most(const RawMesh& mesh, std::span<const EdgeUse> uses) {
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (repeats_vertex(mesh.faces[f]))
      throw Error(
          Fault::mesh_edge_manifold,
          fmt::format("{}: --orient: {} names a vertex twice and has no sides to choose from. Remove such faces.",
                      mesh.name, where(mesh, f)));
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() > 2)
      throw Error(
          Fault::mesh_edge_manifold,
          fmt::format("{}: --orient: the edge between vertices {} and {} has {} faces, the first is {}; which of "
                      "them belong together cannot be told. Separate the sheets by doubling the edge's vertices.",
                      mesh.name, edge[0].low, edge[0].high, edge.size(), where(mesh, edge[0].face)));
  });
}

/// Whether each face has to be flipped so that neighbours agree with the first face of their shell.
std::vector<bool> consistent_flips(const RawMesh& mesh, std::span<const EdgeUse> uses) {
  struct Neighbour {
    const EdgeUse *own, *other;
  };
  std::vector<std::size_t> start(mesh.faces.size() + 1);
  const auto each_pair = [&](auto&& f) {
    for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
      if (edge.size() == 2) f(edge[0], edge[1]), f(edge[1], edge[0]);
    });
  };
  each_pair([&](const EdgeUse& own, const EdgeUse&) { ++start[own.face + 1]; });
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) start[f + 1] += start[f];
  std::vector<Neighbour> neighbours(start.back());
  std::vector<std::size_t> at(start.begin(), start.end() - 1);
  each_pair([&](const EdgeUse& own, const EdgeUse& other) { neighbours[at[own.face]++] = {&own, &other}; });

  std::vector<bool> flip(mesh.faces.size()), seen(mesh.faces.size());
  std::vector<std::uint32_t> front;
  for (std::uint32_t first = 0; first < mesh.faces.size(); ++first) {
    if (seen[first]) continue;
    seen[first] = true;
    front.assign(1, first);
    for (std::size_t i = 0; i < front.size(); ++i)
      for (std::size_t n = start[front[i]]; n < start[front[i] + 1]; ++n) {
        const auto& [own, other] = neighbours[n];
        const bool wanted = flip[own->face] != (own->forward == other->forward);
        if (!seen[other->face]) {
          seen[other->face] = true;
          flip[other->face] = wanted;
          front.push_back(other->face);
        } else if (flip[other->face] != wanted) {
          throw Error(
              Fault::mesh_unbalanced,
              fmt::format("{}: --orient: the shell of {} has one side only, as a Moebius strip: walking round it "
                          "comes back reversed at the edge between vertices {} and {} ({}). It bounds no body.",
                          mesh.name, where(mesh, first), own->low, own->high, where(mesh, other->face)));
        }
      }
  }
  return flip;
}

void flip_face(Face& face) {
  std::swap(face[1], face[2]);
}

/// For each shell whether it lies inside an odd number of others. `closed` says which shells count.
std::vector<bool> cavities(const RawMesh& mesh, std::span<const std::uint32_t> shell, const std::vector<bool>& closed,
                           Monitor& monitor) {
  const std::size_t count = closed.size();
  std::vector<bool> inside(count);
  if (count < 2) return inside;
  const plan::Bvh tree(mesh.vertices, mesh.faces);
  const SelfIntersections found = self_intersections(mesh.vertices, mesh.faces, tree, monitor);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> through; // shells that pass through each other
  std::vector<bool> met(mesh.faces.size());
  for (const FacePair& pair : found.pairs) {
    met[pair.first] = met[pair.second] = true;
    const std::uint32_t a = shell[pair.first], b = shell[pair.second];
    if (a != b && pair.how.meeting != Meeting::touching) through.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(through.begin(), through.end());

  // Where to ask: on a face that nothing touches, if there is one.
  std::vector<std::uint32_t> face_of(count, 0);
  std::vector<int> worth(count, -1);
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    if (const int value = met[f] ? 0 : 1; value > worth[shell[f]]) worth[shell[f]] = value, face_of[shell[f]] = f;
  std::vector<Crossing> crossed;
  std::vector<int> winding(count);
  for (std::uint32_t s = 0; s < count; ++s) {
    if (!closed[s]) continue;
    check_stop(monitor);
    const Face& f = mesh.faces[face_of[s]];
    const Vec3 point = (mesh.vertices[f[0]] + mesh.vertices[f[1]] + mesh.vertices[f[2]]) / 3;
    crossings(tree, mesh.vertices, mesh.faces, point, crossed);
    for (const Crossing& c : crossed) winding[shell[c.face]] += c.sign;
    for (const Crossing& c : crossed) {
      const std::uint32_t other = shell[c.face];
      const bool holds =
          other != s && closed[other] && winding[other] != 0 &&
          !std::binary_search(through.begin(), through.end(), std::pair(std::min(s, other), std::max(s, other)));
      winding[other] = 0; // counted
      if (holds) inside[s] = !inside[s];
    }
  }
  return inside;
}

} // namespace

Orienting orient(RawMesh& mesh, Monitor& monitor) {
  const std::vector<EdgeUse> uses = edge_uses(mesh.faces, mesh.vertices.size());
  require_two_faces_at_most(mesh, uses);
  std::vector<bool> flip = consistent_flips(mesh, uses);
  Orienting result;
  const std::vector<std::uint32_t> shell = shells(mesh.faces, uses, result.shells);
  std::vector<bool> closed(result.shells, true);
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    if (edge.size() != 2) closed[shell[edge[0].face]] = false;
  });

  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (flip[f]) flip_face(mesh.faces[f]);
  const std::vector<ShellSize> sizes = shell_sizes(mesh.vertices, mesh.faces, shell, result.shells);
  const double noise = volume_noise(mesh.vertices, mesh.faces), all = area(mesh.vertices, mesh.faces);
  std::vector<std::size_t> faces(result.shells), turned(result.shells);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) ++faces[shell[f]], turned[shell[f]] += flip[f];
  const std::vector<bool> inside = cavities(mesh, shell, closed, monitor);
  std::vector<bool> again(result.shells);
  for (std::size_t s = 0; s < result.shells; ++s) {
    if (!closed[s] || std::abs(sizes[s].volume) <= noise * (sizes[s].area / all)) {
      ++result.undecided;
      again[s] = 2 * turned[s] > faces[s];
      continue;
    }
    again[s] = (sizes[s].volume < 0) != inside[s];
    result.cavities += inside[s];
  }
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (again[shell[f]]) flip_face(mesh.faces[f]);
    result.flipped += flip[f] != again[shell[f]];
  }
  return result;
}

ShellChoice keep_largest_shell(RawMesh& mesh) {
  ShellChoice choice;
  const std::vector<std::uint32_t> shell =
      shells(mesh.faces, edge_uses(mesh.faces, mesh.vertices.size()), choice.shells);
  if (choice.shells < 2) return choice;
  const std::vector<ShellSize> sizes = shell_sizes(mesh.vertices, mesh.faces, shell, choice.shells);
  const auto largest = std::max_element(sizes.begin(), sizes.end(), [](const ShellSize& a, const ShellSize& b) {
    return std::abs(a.volume) < std::abs(b.volume);
  });
  choice.kept = largest->volume;
  for (const ShellSize& size : sizes)
    if (&size != &*largest) choice.dropped += std::abs(size.volume);

  const auto keep = static_cast<std::uint32_t>(largest - sizes.begin());
  std::vector<std::uint32_t> to(mesh.vertices.size(), 0);
  std::size_t kept = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (shell[f] != keep) continue;
    for (const std::uint32_t v : mesh.faces[f]) to[v] = 1;
    mesh.faces[kept] = mesh.faces[f];
    if (!mesh.face_lines.empty()) mesh.face_lines[kept] = mesh.face_lines[f];
    ++kept;
  }
  choice.faces = mesh.faces.size() - kept;
  mesh.faces.resize(kept);
  if (!mesh.face_lines.empty()) mesh.face_lines.resize(kept);
  std::uint32_t vertices = 0;
  for (std::size_t v = 0; v < to.size(); ++v) {
    if (to[v] == 0) continue;
    mesh.vertices[vertices] = mesh.vertices[v];
    to[v] = vertices++;
  }
  mesh.vertices.resize(vertices);
  for (Face& face : mesh.faces)
    for (std::uint32_t& v : face) v = to[v];
  return choice;
}

namespace {

void mend_weld(RawMesh& mesh, double distance) {
  const Box box = bounding_box(mesh.vertices, mesh.faces);
  if (!(distance >= 0 && distance <= box.longest_side() / 10))
    throw Error(
        Fault::bad_argument,
        fmt::format("--weld {}: it is a length in the mesh's unit, from 0 (vertices at one point exactly) to a tenth "
                    "of the longest side of the mesh's box, {:.6g}",
                    distance, box.longest_side() / 10));
  double largest = 0;
  for (const Vec3& p : mesh.vertices) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  const Weld weld = distance <= 0x1p-60 * largest ? weld_equal_points(mesh) : weld_near_points(mesh, distance);
  mesh.notes.push_back(fmt::format("--weld {}: {} into another, up to {:.3g} away; {} collapsed and left out.",
                                   distance, counted(weld.merged, "vertex was merged", "vertices were merged"),
                                   weld.farthest, counted(weld.collapsed, "face", "faces")));
}

void mend_orientation(RawMesh& mesh, Monitor& monitor) {
  const Orienting done = orient(mesh, monitor);
  std::string note = fmt::format("--orient: {} of {} flipped; {}", counted(done.flipped, "face", "faces"),
                                 mesh.faces.size(), counted(done.shells, "shell", "shells"));
  if (done.cavities)
    note += fmt::format(", {} inside an odd number of others and looking inwards as {}", done.cavities,
                        done.cavities == 1 ? "a cavity" : "cavities");
  if (done.undecided)
    note += fmt::format(", {} open or without volume and left as most of the faces looked", done.undecided);
  mesh.notes.push_back(note + ".");
}

void mend_shells(RawMesh& mesh) {
  const ShellChoice choice = keep_largest_shell(mesh);
  mesh.notes.push_back(
      choice.shells < 2
          ? "--largest-shell: there is one shell; nothing was left out."
          : fmt::format("--largest-shell: {} of {} shells left out, {} of |volume| {:.6g} in all; the one "
                        "kept has the volume {:.6g}.",
                        choice.shells - 1, choice.shells, counted(choice.faces, "face", "faces"), choice.dropped,
                        choice.kept));
}

} // namespace

void mend(RawMesh& mesh, const Mending& mending, Monitor& monitor) {
  if (!mending.any()) return;
  require_valid_indices(mesh);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!mesh.vertices[v].allFinite())
      throw Error(
          Fault::mesh_not_finite,
          fmt::format("{}: vertex {} has no finite coordinates; a mesh is mended only where all have. Repair or "
                      "export it again.",
                      mesh.name, v));
  if (mending.weld) mend_weld(mesh, *mending.weld);
  if (mending.orient) mend_orientation(mesh, monitor);
  if (mending.largest_shell) mend_shells(mesh);
}

} // namespace cowgpu
