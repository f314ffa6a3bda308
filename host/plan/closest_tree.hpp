// The stage `closest`, what its paths share: a tree of boxes 16 wide over triangles, each triangle in a frame of its own,
// and the place on a triangle.
//
// Frames. With u along the longest edge, v towards the third corner and n = u x v, a point has coordinates x, y in the
// triangle's plane and the height z, and its squared distance is z^2 + (inside ? 0 : the least of those from the three
// edges in the plane). The third corner's foot lies between the other two, so that signs of rounded products never call
// a point inside whose foot is off the longest edge: needles are as safe as other triangles.
//
// Single precision decides first: in the tree's units (the box's half extent is 1, its middle 0) a distance from a point
// with coordinates up to M comes out wrong by less than closest_margin max(1, M), boxes are rounded outwards, and what
// is within twice the margin of the best is decided in double precision.
#pragma once

#include "host/distance_field.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

inline constexpr std::size_t closest_width = 16;
inline constexpr float closest_margin = 64 * 0x1p-24F;

/// Queries farther out than this, in the tree's units, leave single precision nothing to decide.
inline constexpr double closest_far = 0x1p18;

/// Boxes of the children, component by component. Unused slots are boxes beyond closest_far.
struct alignas(64) ClosestBoxes {
  float low[3][closest_width], high[3][closest_width];
};

struct ClosestNode {
  ClosestBoxes boxes;
  std::int32_t child[closest_width]; ///< a node, or ~leaf
};

/// A triangle in its own frame. `a` is the corner where its longest edge begins, `b` where that ends. The origin of double
/// frames is a; that of single ones the tree's, with x = u . p - a[0], y = v . p - a[1], z = n . p - a[2].
template <class T>
struct TriangleFrame {
  T a[3];
  T u[3], v[3], n[3];
  T length;             ///< length of ab
  T cx, cy, c_inverse;  ///< c - a in the frame, over its squared length; 0 if that is 0
  T ex, ey, e_inverse;  ///< c - b, the same
  std::uint32_t corner; ///< the face's corner that is a; b and c follow
};
inline constexpr std::size_t frame_numbers = 19;

/// Sixteen triangles: their boxes, and their single frames number by number in the order of TriangleFrame. Unused slots
/// are very far away.
struct ClosestLeaf {
  ClosestBoxes boxes;
  float frame[frame_numbers][closest_width];
};

struct ClosestTree {
  /// Surface-area heuristic. Throws what check_distance_surface throws, and too_large beyond 2^30 faces. O(n log^2 n); some
  /// 480 bytes a face.
  ClosestTree(std::span<const Vec3> vertices, std::span<const Face> faces);

  /// Bytes of a tree over so many faces, about.
  static std::uint64_t bytes(std::uint64_t faces, std::uint64_t vertices);

  /// In the tree's units, rounded to single: monotone in every component.
  std::array<float, 3> local(const Vec3& p) const {
    return {float((p.x() - centre.x()) * scale), float((p.y() - centre.y()) * scale),
            float((p.z() - centre.z()) * scale)};
  }

  /// Single precision has nothing to decide about such a query.
  bool is_far(const Vec3& p) const { return ((p - centre) * scale).cwiseAbs().maxCoeff() > closest_far; }

  /// The closest point of one face.
  SurfacePoint on_face(std::uint32_t face, const Vec3& p) const;

  std::vector<Vec3> vertices;
  std::vector<Face> faces;
  Vec3 low, high;      ///< corners of the box of the vertices in use
  Vec3 centre;         ///< centre of that box
  double size = 0;     ///< largest |coordinate| in use
  double scale = 1;    ///< 1 / half its longest side
  bool closed = false; ///< every edge is run as often one way as the other

  // nodes[0] is the root; of one leaf there is a node above it. Slot s of leaf l is slot 16 l + s of the arrays below.
  std::vector<ClosestNode> nodes;
  std::vector<ClosestLeaf> leaves;
  std::vector<TriangleFrame<float>> single_frames;
  std::vector<TriangleFrame<double>> frames;
  std::vector<std::uint32_t> face_of_slot; ///< no_face for an unused one
  std::vector<std::uint32_t> slot_of_face;

  std::vector<std::uint32_t> face_of_vertex; ///< the least; no_face for a vertex of none
  std::vector<std::array<std::uint32_t, 3>>
      face_of_edge; ///< the least, of the edge from corner k of a face to the next
};

/// Longest path of waiting boxes while walking the tree.
inline constexpr std::size_t closest_stack = 1280;

} // namespace cowgpu::plan
