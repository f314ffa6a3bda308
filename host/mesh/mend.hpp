// Meshes mended on demand: doubled vertices, faces that look the wrong way, loose shells.
#pragma once

#include "host/mesh/raw_mesh.hpp"
#include "host/monitor.hpp"

#include <cstddef>
#include <optional>
#include <string>

namespace cowgpu {

/// What is to be mended, in this order. Nothing is mended unasked.
struct Mending {
  std::optional<double> weld; ///< merge vertices within this distance, in mesh units; 0: at one point exactly
  bool orient = false;
  bool largest_shell = false;

  bool any() const { return weld || orient || largest_shell; }
};

struct Orienting {
  std::size_t shells = 0;
  std::size_t flipped = 0;  ///< faces whose corners were reversed
  std::size_t cavities = 0; ///< shells that look inwards now, as they lie inside an odd number of others
  std::size_t undecided =
      0; ///< shells with open edges or without volume: made consistent, and left as most faces looked
  std::size_t coinciding = 0; ///< shells that lie exactly where an earlier one does, and count as inside it
  bool complete = true; ///< false: faces meet too often (most_pairs) for all to be known, and nesting may be wrong
};

/// Makes every shell (faces joined over edges) consistently oriented, walking from face to face, and then outward: its own
/// signed volume becomes positive, or negative if it lies inside an odd number of other closed shells, as a cavity does. A
/// shell lies inside another if that winds about a point of each of its faces that does not lie on it, and no faces of the two
/// cross: walls in common do not count. Of shells that lie at one place the later one lies inside the earlier; shells that pass
/// through each other both look outwards. Vertices and the order of faces stay; a flipped face keeps its first corner.
///
/// Indices must be valid and coordinates finite. Throws Error(mesh_edge_manifold) for edges of more than two faces and
/// faces that name a vertex twice, with the first of them; mesh_unbalanced for a one-sided shell (as a Moebius strip), with
/// the edge where the walk contradicts itself; interrupted.
Orienting orient(RawMesh& mesh, Monitor& monitor);

struct ShellChoice {
  std::size_t shells = 0; ///< there were
  std::size_t faces = 0;  ///< left out
  double kept = 0;        ///< volume of the shell that stays, signed
  double dropped = 0;     ///< sum of the |volumes| of the others
};

/// Keeps the shell of the largest |volume|, the first of equals, with the vertices it uses in their order. Volumes of open
/// shells are those of the cone over their edges from the middle of the mesh's box.
ShellChoice keep_largest_shell(RawMesh& mesh);

/// Whether mend() has turned the mesh's faces, by the note that it leaves.
bool was_oriented(const RawMesh& mesh);

/// Mends and says in mesh.notes what was done. The result is as raw as before: ClosedSurface::from() judges it. Throws
/// Error(mesh_index_range, mesh_not_finite), what orient() throws, and bad_argument for a `weld` that is not finite, below 0 or above
/// a tenth of the longest side of the mesh's box.
void mend(RawMesh& mesh, const Mending& mending, Monitor& monitor);

} // namespace cowgpu
