// Vertices that lie at one point made one, for files that have no topology of their own.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace cowgpu {

/// Merges points of exactly equal coordinates (-0 equals +0) as they come; NaN equals NaN of the same bits.
class PointWelder {
public:
  /// Merges into `points`, which must be empty and outlive the welder.
  explicit PointWelder(std::vector<Vec3>& points) : points_(points) {}

  /// The index of the point in `points`, appended if it is new. At most 2^32 - 2 points.
  std::uint32_t index(const Vec3& point);

  /// The index of a point that is there, or none.
  static constexpr std::uint32_t none = 0xffffffff;
  std::uint32_t find(const Vec3& point) const;

private:
  void grow();
  std::size_t slot(const Vec3& point) const; // its own, or the free one where it belongs

  std::vector<Vec3>& points_;
  std::vector<std::uint32_t> slots_; // open addressing; a power of two, at most 3/4 full
};

struct Weld {
  std::size_t merged = 0;    ///< vertices that became another
  double farthest = 0;       ///< that a vertex lay from the one it became
  std::size_t collapsed = 0; ///< faces left out because two of their corners became one
};

/// Merges the vertices of `mesh` that lie at exactly one point. Vertices keep the order of their first appearance; faces
/// of which two corners were distinct before and no longer are, which have no area, are left out (with their lines).
/// Indices must be valid.
Weld weld_equal_points(RawMesh& mesh);

/// The same for vertices within `distance` (> 0) of each other, in mesh units. Chains merge whole: vertices of a row whose
/// neighbours are that near become one. It is the first of them, where that lies. Coordinates must be finite. Time is
/// linear unless very many vertices lie within the distance and yet apart.
Weld weld_near_points(RawMesh& mesh, double distance);

/// True if every directed edge occurs as often as its reverse; by a sum of hashes that cancel, without memory. False for
/// all other faces but those whose hashes cancel by chance (one in 2^64), which ClosedSurface then refuses.
bool seems_balanced(std::span<const Face> faces);

} // namespace cowgpu
