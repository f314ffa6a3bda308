// The surface of a body expanded over the distance's flow.
#pragma once

#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "host/requests/expand_surfaces.hpp"

namespace cowgpu {

/// Expands over the distance's flow by the meaning that `choice` asks for; name, recipe and origin's kind of the result
/// are the caller's. Throws what host/flow/flow_map.hpp throws.
void expand_flow(const ExpansionChoice& choice, bool estimate_aliasing, const ManifoldSurface& surface,
                 const Vec3& origin, Backend& backend, Monitor& monitor, SurfaceResult& result);

/// What that needs at most beside what other maps need.
MemoryNeed expand_flow_memory(const FlowChoice& choice, int lmax, std::span<const Vec3> vertices,
                              std::span<const Face> faces, const Backend& backend);

/// The star-shape time of a mesh about an origin, as precisely as every command takes it.
StarShapeTime find_star_shape_time(const RawMesh& mesh, const Vec3& origin, Backend& backend, Monitor& monitor);

/// The mesh's vertices along their normals for `time`.
FlowPoints flow_vertices(const ManifoldSurface& surface, double time, Backend& backend, Monitor& monitor,
                         FlowReport& report);

/// The time a command flows for: the given one, or for 0 that bound of the star-shape time which is surely enough.
double flow_time(double given, const StarShapeTime& star);

/// Throws Error(bad_argument) for a time outside 1e-9 ... 1e4 diagonals of the box, in which distances resolve it.
void check_flow_time(double time, const Box& box);

} // namespace cowgpu
