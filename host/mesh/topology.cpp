#include "host/mesh/topology.hpp"

#include "host/counted.hpp"
#include "host/error.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace cowgpu {

std::vector<EdgeUse> edge_uses(std::span<const Face> faces, std::size_t vertex_count) {
  // Counting sort by `low`, then a small sort within each vertex.
  std::vector<std::size_t> start(vertex_count + 1);
  const auto for_each_side = [&](auto&& f) {
    for (std::size_t face = 0; face < faces.size(); ++face)
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t a = faces[face][i], b = faces[face][(i + 1) % 3];
        if (a != b) f(EdgeUse{std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(face), a < b});
      }
  };
  for_each_side([&](const EdgeUse& use) { ++start[use.low + 1]; });
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<EdgeUse> uses(start.back());
  for_each_side([&](const EdgeUse& use) { uses[start[use.low]++] = use; });
  for (std::size_t vertex = 0, begin = 0; vertex < vertex_count; begin = start[vertex++])
    std::sort(uses.begin() + static_cast<std::ptrdiff_t>(begin),
              uses.begin() + static_cast<std::ptrdiff_t>(start[vertex]), [](const EdgeUse& a, const EdgeUse& b) {
                return std::tie(a.high, a.face, a.forward) < std::tie(b.high, b.face, b.forward);
              });
  return uses;
}

EdgeBalance balance(std::span<const EdgeUse> edge) {
  EdgeBalance result;
  for (const EdgeUse& use : edge) ++(use.forward ? result.forward : result.backward);
  return result;
}

DisjointSets::DisjointSets(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0);
}

std::size_t DisjointSets::find(std::size_t member) {
  while (parent_[member] != member) member = parent_[member] = parent_[parent_[member]];
  return member;
}

void DisjointSets::join(std::size_t a, std::size_t b) {
  a = find(a);
  b = find(b);
  parent_[std::max(a, b)] = std::min(a, b);
}

std::vector<std::uint32_t> vertices_with_several_fans(std::span<const Face> faces, std::span<const EdgeUse> uses,
                                                      std::size_t vertex_count) {
  // Corners (3 face + i) that share an edge at their vertex belong to one fan. A face that names a vertex twice has one
  // corner there: the first.
  const auto corner = [&](std::size_t face, std::uint32_t vertex) {
    std::size_t i = 0;
    while (faces[face][i] != vertex) ++i;
    return 3 * face + i;
  };
  DisjointSets fans(3 * faces.size());
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    for (const EdgeUse& use : edge.subspan(1)) {
      fans.join(corner(edge[0].face, use.low), corner(use.face, use.low));
      fans.join(corner(edge[0].face, use.high), corner(use.face, use.high));
    }
  });
  std::vector<std::uint8_t> found(vertex_count); // fans so far, held at 2
  for (std::size_t i = 0; i < 3 * faces.size(); ++i) {
    const std::uint32_t vertex = faces[i / 3][i % 3];
    if (corner(i / 3, vertex) == i && fans.find(i) == i && found[vertex] < 2) ++found[vertex];
  }
  std::vector<std::uint32_t> result;
  for (std::size_t vertex = 0; vertex < vertex_count; ++vertex)
    if (found[vertex] == 2) result.push_back(static_cast<std::uint32_t>(vertex));
  return result;
}

std::vector<std::uint32_t> shells(std::span<const Face> faces, std::span<const EdgeUse> uses, std::size_t& count) {
  DisjointSets sets(faces.size());
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    for (const EdgeUse& use : edge.subspan(1)) sets.join(edge[0].face, use.face);
  });
  count = 0;
  std::vector<std::uint32_t> shell(faces.size());
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const std::size_t first = sets.find(face); // the smallest, so numbered already
    shell[face] = first == face ? static_cast<std::uint32_t>(count++) : shell[first];
  }
  return shell;
}

std::size_t unused_vertices(std::span<const Face> faces, std::size_t vertex_count) {
  std::vector<bool> used(vertex_count);
  for (const Face& face : faces)
    for (const std::uint32_t vertex : face) used[vertex] = true;
  return static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
}

void require_valid_indices(const RawMesh& mesh) {
  for (std::size_t face = 0; face < mesh.faces.size(); ++face)
    for (const std::uint32_t vertex : mesh.faces[face])
      if (vertex >= mesh.vertices.size())
        throw Error(Fault::mesh_index_range,
                    fmt::format("{}: {} names vertex {}, but there {} {}, numbered from 0. Export the mesh again.",
                                called(mesh), where(mesh, face), vertex, mesh.vertices.size() == 1 ? "is" : "are",
                                counted(mesh.vertices.size(), "vertex", "vertices")));
}

std::string called(const RawMesh& mesh) {
  return mesh.name.empty() ? "the mesh" : mesh.name;
}

std::string where(const RawMesh& mesh, std::size_t face) {
  if (face < mesh.face_lines.size()) return fmt::format("face {}, line {}", face, mesh.face_lines[face]);
  return fmt::format("face {}", face);
}

} // namespace cowgpu
