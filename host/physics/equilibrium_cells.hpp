// The cells of the search for equilibria: boxes in the frame of the spin.
#pragma once

#include "host/mesh/body.hpp"
#include "host/physics/equilibria.hpp"
#include "host/types.hpp"

#include <Eigen/Core>

#include <vector>

namespace cowgpu::physics {

/// A box about `centre` with half sides `half`, in the frame of the spin.
struct Cell {
  Vec3 centre, half;
};

/// Its z axis is the spin's, and its origin the point that this goes through.
class SpinFrame {
public:
  SpinFrame(const Body& body, const Spin& spin);

  Vec3 inward(const Vec3& mesh) const { return axes_.transpose() * (mesh - origin_); }
  Vec3 outward(const Vec3& place) const { return origin_ + axes_ * place; }
  Vec3 turned(const Vec3& vector) const { return axes_.transpose() * vector; }
  Eigen::Matrix3d turned(const Eigen::Matrix3d& tensor) const { return axes_.transpose() * tensor * axes_; }

  /// An upper bound of the distance of a vertex from a place, by the box of all in this frame.
  double farthest_vertex(const Vec3& place) const { return (place - box_middle_).cwiseAbs().norm() + box_half_.norm(); }

  /// The box of all vertices in this frame.
  Vec3 box_low() const { return box_middle_ - box_half_; }
  Vec3 box_high() const { return box_middle_ + box_half_; }

  /// Of cells, in the frame's places: the ball that holds them, in mesh coordinates, and whether they go round the axis.
  UndecidedPlace place_of(const std::vector<Cell>& group) const;

  double low = 0, high = 0; ///< of the vertices along the axis
  double reach = 0;         ///< their largest distance from the axis

private:
  Eigen::Matrix3d axes_;
  Vec3 origin_, box_middle_, box_half_;
};

/// Adds the parts of a cell that is halved along all sides but those much shorter than its longest.
void cut(const Cell& cell, std::vector<Cell>& to);

/// The cells in groups that touch each other, or nearly: no two groups are nearer than a side of the largest cell.
std::vector<std::vector<Cell>> touching(const std::vector<Cell>& cells);

/// Whether a place is in one of the cells.
bool holds(const std::vector<Cell>& group, const Vec3& place);

} // namespace cowgpu::physics
