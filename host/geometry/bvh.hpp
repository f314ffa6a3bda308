// A hierarchy of boxes over triangles, for rays and for closest points.
#pragma once

#include "host/types.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace cowgpu {

struct Ray {
  Vec3 origin, direction;                                 ///< the direction of any length but 0
  double limit = std::numeric_limits<double>::infinity(); ///< what lies further than limit * direction is not seen
};

struct RayHit {
  std::uint32_t face = 0; ///< index of the input
  double t = 0;           ///< hit = origin + t direction
  double u = 0, v = 0;    ///< hit = (1 - u - v) a + u b + v c
};

struct ClosestPoint {
  std::uint32_t face = 0;
  Vec3 point = Vec3::Zero();
  double distance2 = std::numeric_limits<double>::infinity(); ///< squared
};

/// Binary tree; boxes and triangles are copied. Where several triangles do equally well the least index wins, so results
/// do not depend on the tree. Reading is safe from several threads.
class Bvh {
public:
  /// Splits by the surface-area heuristic in 16 bins (Wald, Symp. Interactive Ray Tracing 2007); O(n log n). Indices must be
  /// valid and coordinates finite; faces without area are never hit but can be closest. Needs 72 bytes a face for the
  /// triangles and 64 a node, about one node a face.
  Bvh(std::span<const Vec3> vertices, std::span<const Face> faces);

  /// The first triangle along the ray with 0 <= t <= limit, from either side. Edges and corners belong to the triangles,
  /// with a margin of 1e-12 of the barycentric coordinates, so that no ray slips between neighbours.
  bool first_hit(const Ray& ray, RayHit& hit) const;

  /// The closest point of all triangles, if it is nearer than the square root of `below`; else distance2 is infinite.
  /// Triangles by Voronoi regions (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
  ClosestPoint closest(const Vec3& point, double below = std::numeric_limits<double>::infinity()) const;

  struct alignas(64) Node {
    Vec3 low, high;
    std::uint32_t first = 0; ///< a leaf's first triangle; another node's second child. The first child is the next node
    std::uint32_t count = 0; ///< triangles, at most leaf_faces; 0: no leaf
  };
  static constexpr std::uint32_t leaf_faces = 4;
  // A node at depth d halves its triangles from d = 64 on, so no path is longer.
  static constexpr int halving_depth = 64, deepest = halving_depth + 33;

  /// The root first; triangles of neighbouring leaves follow each other.
  std::span<const Node> nodes() const { return nodes_; }
  /// Of the triangles in the order of the leaves.
  std::span<const std::uint32_t> faces() const { return faces_; }

private:
  struct Triangle {
    Vec3 a, ab, ac;
  };
  struct Builder;

  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;  ///< in the order of the leaves
  std::vector<std::uint32_t> faces_; ///< their indices in the input
};

} // namespace cowgpu
