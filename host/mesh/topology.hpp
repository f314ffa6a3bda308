// What hangs together in a set of faces: edges, fans round vertices, shells. Shared by the checks and the audit.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace cowgpu {

/// One side of a face, on the undirected edge low - high. `forward`: the face runs it from low to high.
struct EdgeUse {
  std::uint32_t low, high, face;
  bool forward;
};

/// Every side of every face, sorted by (low, high, face), so that the uses of an edge lie together. Sides from a vertex
/// to itself are left out. The indices must be valid. Time is linear in the faces unless single vertices have very
/// many.
std::vector<EdgeUse> edge_uses(std::span<const Face> faces, std::size_t vertex_count);

/// Calls `f(std::span<const EdgeUse>)` with the uses of each undirected edge, in the order of `uses`.
template <class Function>
void for_each_edge(std::span<const EdgeUse> uses, Function&& f) {
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].low == uses[begin].low && uses[end].high == uses[begin].high) ++end;
    f(uses.subspan(begin, end - begin));
  }
}

/// How often faces run an edge from low to high, and back.
struct EdgeBalance {
  std::size_t forward = 0, backward = 0;
  bool balanced() const { return forward == backward; }
};
EdgeBalance balance(std::span<const EdgeUse> edge);

/// True if the face names a vertex twice.
inline bool repeats_vertex(const Face& f) {
  return f[0] == f[1] || f[1] == f[2] || f[2] == f[0];
}

/// Sets that are merged; each is known by its smallest member.
class DisjointSets {
public:
  explicit DisjointSets(std::size_t count);
  std::size_t find(std::size_t member);
  void join(std::size_t a, std::size_t b);

private:
  std::vector<std::size_t> parent_;
};

/// The vertices whose faces form several fans (faces of a fan share edges at the vertex), in ascending order.
std::vector<std::uint32_t> vertices_with_several_fans(std::span<const Face> faces, std::span<const EdgeUse> uses,
                                                      std::size_t vertex_count);

/// For each face the number of its shell; shells are sets of faces connected over edges, numbered in order of
/// appearance. `count` receives how many there are.
std::vector<std::uint32_t> shells(std::span<const Face> faces, std::span<const EdgeUse> uses, std::size_t& count);

/// How many vertices belong to no face.
std::size_t unused_vertices(std::span<const Face> faces, std::size_t vertex_count);

/// Throws Error(Fault::mesh_index_range), naming the first face with a vertex that does not exist.
void require_valid_indices(const RawMesh& mesh);

/// What messages call it: its name, or "the mesh" where it has none, as those made from arrays.
std::string called(const RawMesh& mesh);

/// "face 33, line 2801": faces count from 0; the line is left out where none is known.
std::string where(const RawMesh& mesh, std::size_t face);

} // namespace cowgpu
