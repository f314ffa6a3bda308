// A map of a closed genus-0 surface to the unit sphere.
#pragma once

#include "host/map/map_method.hpp"
#include "host/mesh/closed_surface.hpp"

#include <string>
#include <vector>

namespace cowgpu {

/// Where each vertex of a surface goes on the sphere; triangles go to the spherical triangles between their corners. A
/// map that keeps the orientation sends a face seen counter-clockwise from outside the body to a spherical triangle seen
/// counter-clockwise from outside the sphere.
struct SphereMap {
  MapMethod method = MapMethod::file;
  std::vector<Vec3> positions;    ///< unit vectors, one per vertex of the mesh, in its order; zero for unused vertices
  std::vector<std::string> notes; ///< sentences: what was chosen and what came of it ("vertex 408 deleted ...")
};

} // namespace cowgpu
