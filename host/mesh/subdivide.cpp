#include "host/mesh/subdivide.hpp"

#include "host/error.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>

namespace cowgpu {
namespace {

using Index = std::uint32_t;

/// The undirected edges of a mesh, sorted by smaller, then larger end.
struct Edges {
  std::vector<std::array<Index, 2>> ends;
  std::vector<std::array<Index, 3>> of_face; ///< edge k of a face joins its corners k and k + 1
};

void check_indices(const RawMesh& mesh) {
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (Index v : mesh.faces[f])
      if (v >= mesh.vertices.size())
        throw Error(Fault::mesh_index_range, "Cannot subdivide: face " + std::to_string(f) + " names vertex " +
                                                 std::to_string(v) + ", and the mesh has " +
                                                 std::to_string(mesh.vertices.size()) + " vertices, counted from 0.");
}

[[noreturn]] void refuse_size(std::size_t faces) {
  throw Error(Fault::too_large, "Cannot subdivide a mesh of " + std::to_string(faces) +
                                    " faces: the result would need indices beyond 32 bits.");
}

// Sorted in buckets by smaller end rather than hashed: the order is the same everywhere, and 50 million faces fit.
Edges find_edges(const RawMesh& mesh) {
  struct Side {
    Index larger;
    Index corner; ///< 3 face + corner
  };
  const std::size_t n_sides = 3 * mesh.faces.size();
  if (n_sides > std::numeric_limits<Index>::max()) refuse_size(mesh.faces.size());

  auto side_ends = [&](std::size_t f, std::size_t k) {
    return std::minmax({mesh.faces[f][k], mesh.faces[f][(k + 1) % 3]});
  };
  std::vector<Index> begin(mesh.vertices.size() + 1, 0);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) ++begin[side_ends(f, k).first + 1];
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) begin[v + 1] += begin[v];

  std::vector<Side> sides(n_sides);
  std::vector<Index> fill(begin.begin(), begin.end() - 1);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [smaller, larger] = side_ends(f, k);
      sides[fill[smaller]++] = {larger, static_cast<Index>(3 * f + k)};
    }

  Edges edges;
  edges.of_face.resize(mesh.faces.size());
  edges.ends.reserve(n_sides / 2);
  for (Index v = 0; v < mesh.vertices.size(); ++v) {
    const auto first = sides.begin() + begin[v], last = sides.begin() + begin[v + 1];
    std::sort(first, last, [](const Side& a, const Side& b) {
      return a.larger != b.larger ? a.larger < b.larger : a.corner < b.corner;
    });
    for (auto side = first; side != last; ++side) {
      if (side == first || side->larger != (side - 1)->larger) edges.ends.push_back({v, side->larger});
      edges.of_face[side->corner / 3][side->corner % 3] = static_cast<Index>(edges.ends.size() - 1);
    }
  }
  if (mesh.vertices.size() + edges.ends.size() > std::numeric_limits<Index>::max()) refuse_size(mesh.faces.size());
  return edges;
}

/// The four faces of each face, with the new vertex of edge e at index (old vertices) + e; no vertices yet.
RawMesh split_faces(const RawMesh& mesh, const Edges& edges) {
  RawMesh result;
  result.name = mesh.name;
  result.notes = mesh.notes;
  result.faces.reserve(4 * mesh.faces.size());
  const auto old_vertices = static_cast<Index>(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto [a, b, c] = mesh.faces[f];
    const Index ab = old_vertices + edges.of_face[f][0];
    const Index bc = old_vertices + edges.of_face[f][1];
    const Index ca = old_vertices + edges.of_face[f][2];
    result.faces.insert(result.faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  result.face_lines.reserve(4 * mesh.face_lines.size());
  for (std::uint32_t line : mesh.face_lines) result.face_lines.insert(result.face_lines.end(), 4, line);
  return result;
}

void check_closed_manifold(const RawMesh& mesh, const Edges& edges) {
  std::vector<std::uint8_t> up(edges.ends.size(), 0), down(edges.ends.size(), 0);
  auto refuse = [&](Fault fault, std::size_t e, const std::string& why) {
    throw Error(fault, "Loop subdivision needs a closed, oriented 2-manifold: the edge from vertex " +
                           std::to_string(edges.ends[e][0]) + " to " + std::to_string(edges.ends[e][1]) + why);
  };
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t e = edges.of_face[f][k];
      if (up[e] + down[e] == 2) refuse(Fault::mesh_edge_manifold, e, " has more than two faces.");
      ++(mesh.faces[f][k] == edges.ends[e][0] ? up : down)[e];
    }
  for (std::size_t e = 0; e < edges.ends.size(); ++e) {
    if (up[e] + down[e] == 1) refuse(Fault::mesh_open, e, " has a face on one side only.");
    if (up[e] != down[e]) refuse(Fault::mesh_unbalanced, e, " is run through twice in one direction.");
  }
}

} // namespace

RawMesh loop_subdivide(const RawMesh& mesh) {
  check_indices(mesh);
  const Edges edges = find_edges(mesh);
  check_closed_manifold(mesh, edges);
  RawMesh result = split_faces(mesh, edges);

  const std::size_t old_vertices = mesh.vertices.size();
  result.vertices.assign(old_vertices + edges.ends.size(), Vec3::Zero());
  std::vector<Index> valence(old_vertices, 0);
  for (std::size_t e = 0; e < edges.ends.size(); ++e) {
    const auto [a, b] = edges.ends[e];
    result.vertices[old_vertices + e] = 0.375 * (mesh.vertices[a] + mesh.vertices[b]);
    result.vertices[a] += mesh.vertices[b];
    result.vertices[b] += mesh.vertices[a];
    ++valence[a], ++valence[b];
  }
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      result.vertices[old_vertices + edges.of_face[f][k]] += 0.125 * mesh.vertices[mesh.faces[f][(k + 2) % 3]];

  for (std::size_t v = 0; v < old_vertices; ++v) {
    if (valence[v] == 0) { // a vertex of no face stays where it is
      result.vertices[v] = mesh.vertices[v];
      continue;
    }
    const double n = valence[v];
    const double n_beta = valence[v] == 3 ? 9.0 / 16 : 3.0 / 8;
    result.vertices[v] = (1 - n_beta) * mesh.vertices[v] + (n_beta / n) * result.vertices[v];
  }
  return result;
}

RawMesh split_midpoint(const RawMesh& mesh) {
  check_indices(mesh);
  const Edges edges = find_edges(mesh);
  RawMesh result = split_faces(mesh, edges);
  result.vertices.reserve(mesh.vertices.size() + edges.ends.size());
  result.vertices = mesh.vertices;
  for (const auto& [a, b] : edges.ends) result.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
  return result;
}

} // namespace cowgpu
