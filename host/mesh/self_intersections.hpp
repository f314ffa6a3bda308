// Where a surface meets itself.
#pragma once

#include "host/geometry/bvh.hpp"
#include "host/mesh/triangle_pair.hpp"
#include "host/monitor.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu {

/// Two faces that meet beyond what they share.
struct FacePair {
  std::uint32_t first = 0, second = 0; ///< first < second
  TrianglePair how;
};

/// Pairs of faces that meet. A surface passes through itself in crossing and overlapping pairs, and along touching ones
/// where an edge of one sheet lies in a face of the other; sheets that only lean against each other touch too. Vertices of
/// different numbers at one point touch: seams of doubled vertices do all along.
struct SelfIntersections {
  std::vector<FacePair> pairs; ///< sorted by first, then second; at most most_pairs
  std::size_t crossing = 0, overlapping = 0, touching = 0;
  std::size_t faces = 0; ///< in crossing or overlapping pairs
  bool complete = true;  ///< false: the search ended at most_pairs, counts are from below

  /// Pairs that are more than touching.
  std::size_t intersecting() const { return crossing + overlapping; }
};
inline constexpr std::size_t most_pairs = std::size_t(1) << 22;

/// All pairs, by exact signs (triangle_pair.hpp); the same on any number of threads. Faces without area (all corners exactly on
/// a line) are left out: they are degenerate and bound nothing. `tree` is that of these faces. Indices must be valid and
/// coordinates finite, of at most 1e100. Time grows with the faces and with pairs of overlapping boxes. Throws
/// Error(interrupted).
SelfIntersections self_intersections(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree,
                                     Monitor& monitor, unsigned threads = 0);

} // namespace cowgpu
