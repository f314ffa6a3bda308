// Maps to the sphere to sample: even ones, folded ones, crowded ones.
#pragma once

#include "host/sphere_grid.hpp"
#include "host/types.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace cowgpu::test {

/// Where the vertices of a mesh go on the sphere.
struct MappedMesh {
  std::string name;
  std::vector<Vec3> positions; ///< unit vectors
  std::vector<Face> faces;
};

MappedMesh identity_map(int level); ///< an icosphere as it is
MappedMesh rotated_map(int level, std::uint32_t seed);
/// Each vertex moved by at most `size` at random; flip-free while that is below a quarter of an edge.
MappedMesh warped_map(int level, double size, std::uint32_t seed);
/// Angles below 60 degrees from a place, as shares of 60 degrees, raised to this power: triangles as small as doubles have.
MappedMesh crowded_map(int level, double power);
/// Vertices anywhere on the sphere.
MappedMesh random_map(int level, std::uint32_t seed);
MappedMesh tetrahedron_map();
MappedMesh octahedron_map(); ///< corners on the axes
/// The octahedron with the middle of an edge as a vertex of one of its two faces, and a flat triangle in between.
MappedMesh flat_triangle_map();
/// A triangulation whose vertices are the points of this grid, with the poles put in where there are none.
MappedMesh grid_map(const SphereGrid& grid);

} // namespace cowgpu::test
