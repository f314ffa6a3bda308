// What there is to say about a mesh before anything is computed from it. It judges nothing; ClosedSurface does.
#pragma once

#include "host/mesh/geometry.hpp"
#include "host/mesh/raw_mesh.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace cowgpu {

/// Plain facts about a mesh. Counts of things that are wrong are 0 on a good mesh.
struct Audit {
  std::size_t vertices = 0; ///< all, used or not
  std::size_t faces = 0;    ///< triangles
  std::size_t edges = 0;    ///< distinct undirected edges between different vertices

  // Topology: by vertex numbers only, positions play no part.
  std::size_t open_edges = 0;            ///< edges with an odd number of faces
  std::size_t unbalanced_edges = 0;      ///< edges run oftener in one direction, by two or more
  std::size_t crowded_edges = 0;         ///< edges with more than two faces
  std::size_t pinched_vertices = 0;      ///< vertices whose faces form more than one fan
  std::size_t unused_vertices = 0;       ///< vertices of no face
  std::size_t repeating_faces = 0;       ///< faces that name a vertex twice
  std::size_t duplicate_faces = 0;       ///< faces whose three vertices, in any order, an earlier face has
  bool closed = false;                   ///< there are faces and no open edges
  bool consistently_oriented = false;    ///< no unbalanced edges
  bool edge_manifold = false;            ///< no crowded edges, no repeating faces (open edges are allowed)
  bool vertex_manifold = false;          ///< no pinched vertices
  std::size_t components = 0;            ///< shells: sets of faces connected over edges
  std::int64_t euler_characteristic = 0; ///< used vertices - edges + faces
  std::optional<std::int64_t> genus;     ///< summed over the shells; of closed, oriented manifolds only

  // Geometry: from here on only if all coordinates are finite.
  bool finite = false; ///< no NaN, no infinity, used or not
  std::size_t not_finite_vertices = 0;
  std::size_t degenerate_faces = 0;  ///< repeating faces, and those of no area within the rounding of their coordinates
  std::size_t coincident_groups = 0; ///< places where several vertices lie
  Box box;                           ///< bounding box of the used vertices
  double area = 0;                   ///< sum over all faces
  double shortest_edge = 0, longest_edge = 0; ///< between different vertices; 0 without edges

  // Volumes: only of finite, closed, consistently oriented surfaces.
  std::optional<double> volume;       ///< signed, by winding number
  bool outward = false;               ///< the volume is positive beyond volume_noise()
  std::size_t cavities = 0;           ///< shells whose own volume is negative beyond rounding
  std::optional<Vec3> centre_of_mass; ///< at uniform density; missing also if the volume cannot be told from zero
};

/// Looks at a mesh. Throws Error only for indices that do not exist (mesh_index_range); everything else becomes a fact.
Audit audit(const RawMesh& mesh);

} // namespace cowgpu
