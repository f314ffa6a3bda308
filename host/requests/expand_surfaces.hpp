// The surface of a body expanded over maps to the sphere.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"
#include "host/report/surface_result.hpp"

#include <span>
#include <string>
#include <vector>

namespace cowgpu {

/// How the surface is expanded over the distance's flow.
struct FlowChoice {
  double time = 0;     ///< T > 0 in the mesh's length unit; 0: the least from which the inflated body is star-shaped
  bool sheets = false; ///< signed sheets instead of the level set
  /// Least degree of the grid that a level set is met on: its sutures cut the fields, so that errors fall slowly.
  int grid_degree = 1024;
  int refinements = 3; ///< refinements of the mesh, for sheets and the paper's recipe
};

/// Which expansions are asked for.
struct ExpansionChoice {
  bool mass = false;
  std::vector<MapMethod> maps; ///< some of made_maps, in its order, each once
  bool paper = false;          ///< the harmonic map and the flow by the paper's recipe
  std::string map_file;        ///< a PLY file instead of making the one map, or empty
  int lmax = 0;
  FlowChoice flow;
};

/// Throws Error(bad_argument) for the paper's recipe without the harmonic map or the flow, and for a map file without just one
/// map that it stands for.
void check_expansions(const ExpansionChoice& choice);

/// What the largest of the surface expansions needs, and all results; nothing where none is asked for.
MemoryNeed surfaces_memory(const ExpansionChoice& choice, std::uint64_t faces, const Backend& backend);

/// Maps, or reads the map, and expands, about the body's origin; by the paper's recipe about the mesh's. Throws
/// Error(mesh_edge_manifold, mesh_vertex_manifold) and what maps, read_map() and expand_surface() throw.
std::vector<SurfaceResult> expand_surfaces(const ExpansionChoice& choice, bool estimate_aliasing, const Body& body,
                                           Backend& backend, Monitor& monitor);

/// Throws Error(check_failed) with the sentence of the first expansion that came out unfit for use (FlowResult::failure).
void check_surfaces(std::span<const SurfaceResult> results);

} // namespace cowgpu
