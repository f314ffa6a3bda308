// What a flow asks of a surface: feet on single triangles, the nearest triangle, the winding number.
#pragma once

#include "host/plan/closest_tree.hpp"
#include "host/types.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// The closest point of one triangle.
struct Foot {
  Vec3 point = Vec3::Zero();
  double distance = 0;
  bool inside = false; ///< off the triangle's edges and corners
};

/// Reading is safe from several threads.
class FlowSurface {
public:
  /// Throws what check_distance_surface throws, and Error(mesh_open) for a surface that is not closed.
  FlowSurface(std::span<const Vec3> vertices, std::span<const Face> faces);

  const ClosestTree& tree() const { return tree_; }
  std::size_t faces() const { return normals_.size(); }
  double diagonal() const { return diagonal_; }                           ///< diagonal of the bounding box
  const Vec3& normal(std::uint32_t face) const { return normals_[face]; } ///< outwards; zero for a face without area

  const TriangleFrame<double>& frame(std::uint32_t face) const { return frames_[face]; }

  /// As ClosestTree::on_face, less what a flow does not need.
  Foot foot(std::uint32_t face, const Vec3& x) const;

  /// A face with the least distance from x. `warm`: no_face, or a face that may be near x.
  std::uint32_t nearest(const Vec3& x, std::uint32_t warm) const;

  /// How often the surface winds round x.
  int winding_number(const Vec3& x) const;

  /// Places along a Morton curve, so that neighbours in the work are neighbours in space.
  std::vector<std::uint32_t> order(std::span<const Vec3> points, unsigned threads) const;

private:
  ClosestTree tree_;
  std::vector<TriangleFrame<double>> frames_; ///< face by face
  std::vector<Vec3> normals_;
  double diagonal_ = 0;
};

} // namespace cowgpu::plan
