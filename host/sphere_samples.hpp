// The verb `sample`: for every point of a grid, where on a mapped surface it lies.
#pragma once

#include "host/memory_need.hpp"
#include "host/monitor.hpp"
#include "host/run_report.hpp"
#include "host/types.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
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

/// Finds for every point of a grid the triangle of a map to the sphere that the ray from the centre in its direction
/// (SphereDirections) meets, and where. A triangle holds its edges and corners; signs are exact, so a closed mesh leaves no
/// gap. Where several triangles hold a direction, the least (flipped, face index) has it, flipped meaning det(a, b, c) < 0;
/// triangles with det 0 hold none (host/plan/sample.hpp). Every path gives the same faces; weights agree to 1e-15.
class SphereSampler {
public:
  virtual ~SphereSampler() = default;

  /// Upper bound of what sample() allocates for so many faces, its result included. A map's size is known before the map.
  virtual MemoryNeed memory(std::uint64_t faces) const = 0;

  /// `positions` are unit vectors, one per vertex, to 1e-9. Throws Error(map_failed) for a direction that no triangle holds,
  /// bad_argument, too_large, device_failed, device_lost, interrupted. Of the report, seconds, setup_seconds and kernels are
  /// set.
  virtual SphereSamples sample(std::span<const Vec3> positions, std::span<const Face> faces, Monitor& monitor,
                               RunReport* report = nullptr) const = 0;
};

} // namespace cowgpu
