// The surface of a body expanded over maps to the sphere.
#pragma once

#include "host/backend.hpp"
#include "host/map/harmonic.hpp"
#include "host/mesh/body.hpp"
#include "host/report/surface_result.hpp"

#include <span>
#include <string>
#include <vector>

namespace cowgpu {

/// What is expanded over the distance's flow where streamlines merge and folds would be.
enum class FlowMeaning {
  level_set, ///< from a direction back to the surface, by the level set
  sheets,    ///< all sheets of the flowed surface over a direction, each with its sign
  steps,     ///< the mesh's vertices in fixed steps, and what their triangles span; beside it the sheets, converged
};

/// How the surface is expanded over the distance's flow.
struct FlowChoice {
  FlowMeaning meaning = FlowMeaning::level_set;
  double time = 0;    ///< T > 0 in the mesh's length unit; 0: the least from which the inflated body is star-shaped
  double step = 0.05; ///< length of a fixed step
  /// Least degree of the grid that a level set is met on: its sutures cut the fields, so that errors fall slowly.
  int grid_degree = 1024;
  int refinements = 3; ///< refinements of the mesh, for sheets and beside fixed steps
};

/// How a map is read where a surface is expanded over it.
struct MapReading {
  bool closest_point = false;     ///< by the closest point of the mapped triangles' chords, else by a ray
  bool signed_dphi = true;        ///< false: the absolute value of f_dphi is expanded
  bool mesh_origin = false;       ///< about the mesh's origin, else about the body's
  bool estimate_aliasing = false; ///< whether asked for or not
  bool beside_paper = false;      ///< the paper's table is laid beside it, where the mesh is the paper's
  std::string recipe = "default"; ///< what the result calls the settings of map and reading
};

/// Which expansions are asked for.
struct ExpansionChoice {
  bool mass = false;
  std::vector<MapMethod> maps; ///< some of made_maps, in its order, each once
  HarmonicOptions harmonic;    ///< how the harmonic map is made
  MapReading reading;          ///< how the harmonic map and the flow are read; others by rays about the body's origin
  std::string map_file;        ///< a PLY file instead of making the one map, or empty
  int lmax = 0;
  FlowChoice flow;
};

/// Throws Error(bad_argument) for a map file without just one map that it stands for.
void check_expansions(const ExpansionChoice& choice);

/// What the largest of the expansions of a surface needs, and all results; nothing where none is asked for.
MemoryNeed surfaces_memory(const ExpansionChoice& choice, std::span<const Vec3> vertices, std::span<const Face> faces,
                           const Backend& backend);

/// Maps, or reads the map, and expands. Throws
/// Error(mesh_edge_manifold, mesh_vertex_manifold) and what maps, read_map() and expand_surface() throw.
std::vector<SurfaceResult> expand_surfaces(const ExpansionChoice& choice, bool estimate_aliasing, const Body& body,
                                           Backend& backend, Monitor& monitor);

/// Throws Error(check_failed) with the sentence of the first expansion that came out unfit for use (FlowResult::failure).
void check_surfaces(std::span<const SurfaceResult> results);

} // namespace cowgpu
