// Level sets of numbers on a lattice, as triangles.
#pragma once

#include "host/types.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu {

/// Where a level set crosses a lattice's edges.
struct LatticeSurface {
  /// Vertex i lies between these two points of the lattice, by their places among the values; the first has less than the level.
  std::vector<std::array<std::uint64_t, 2>> edges;
  std::vector<Face> faces; ///< counter-clockwise seen from where values are less
};

/// Of `values` at points[0] x points[1] x points[2] places, the first index running fastest. By six tetrahedra a cube (Freudenthal's,
/// which agree from cube to cube): a 2-manifold whose boundary lies on the lattice's. A value equal to the level counts as
/// more. Throws Error(bad_argument) for fewer than two points along a side, too_large beyond 2^31 vertices. Memory: about 60
/// bytes a vertex.
LatticeSurface march_tetrahedra(std::span<const double> values, const std::array<int, 3>& points, double level);

} // namespace cowgpu
