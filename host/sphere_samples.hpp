// What the verb `sample` finds: for every point of a grid, where on a mapped surface it lies.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cowgpu {

/// For every point of a SphereGrid a face and a place on it; layout [ring][longitude].
struct SphereSamples {
  int rings = 0, ring_length = 0;
  std::vector<std::uint32_t> faces;           ///< face index
  std::vector<std::array<double, 3>> weights; ///< weights of the face's corners, in its order; not negative, sum 1
  std::uint64_t faces_hit = 0;                ///< different faces among `faces`
  std::uint64_t folded_points = 0;            ///< points inside (edges left out) more than one triangle
  std::uint64_t edge_points = 0;              ///< points exactly on an edge or a corner of their triangle
  std::uint64_t flipped_points = 0;           ///< points whose triangle is flipped
  std::uint64_t flipped_faces = 0;            ///< triangles of the map with det(a, b, c) < 0
  std::uint64_t flat_faces = 0;               ///< triangles of the map with det(a, b, c) = 0: never hit
  /// Pairs of a point and a triangle that rounding left open and exact arithmetic on the host decided; may differ by path.
  std::uint64_t exact_decisions = 0;

  std::size_t points() const { return faces.size(); }
};

} // namespace cowgpu
