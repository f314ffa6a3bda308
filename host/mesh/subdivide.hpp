// Refinement of triangle meshes: each triangle becomes four, by one new vertex on every edge.
#pragma once

#include "host/mesh/raw_mesh.hpp"

namespace cowgpu {

/// One step of Loop's subdivision (C. Loop, Smooth subdivision surfaces based on triangles, University of Utah, 1987)
/// with J. Warren's vertex weights (Subdivision methods for geometric design, 1995). A new vertex is
/// 3/8 (a + b) + 1/8 (c + d), for the edge ab and the corners c, d facing it; an old one of n neighbours becomes
/// (1 - n beta) v + beta (sum of neighbours), beta = 3/16 for n = 3 and 3/(8 n) otherwise. These weights are rational,
/// so the result is the same on machines whose cosines differ.
///
/// `mesh` must be a closed, consistently oriented 2-manifold; so is the result. Old vertices keep their index, new ones
/// follow in the order of their edges (smaller end, then larger end); face f becomes 4f .. 4f+3 and keeps its line and
/// its orientation. The name and the notes are kept, `sha256` is emptied.
///
/// Throws mesh_index_range, mesh_open (an edge with one face), mesh_edge_manifold (more than two), mesh_unbalanced
/// (both faces run the same way), too_large (indices beyond 32 bits).
RawMesh loop_subdivide(const RawMesh& mesh);

/// Each triangle cut into four at the midpoints of its edges; the surface stays where it is. Works on any triangle
/// mesh; a midpoint is shared by all faces at an edge (the same two vertex indices), so closed stays closed.
/// Numbering as for loop_subdivide. Throws mesh_index_range, too_large.
RawMesh split_midpoint(const RawMesh& mesh);

} // namespace cowgpu
