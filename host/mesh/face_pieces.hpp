// A face cut along the segments in which others meet it.
#pragma once

#include "host/types.hpp"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace cowgpu {

using Vec2 = Eigen::Vector2d;
using Segment2 = std::pair<Vec2, Vec2>;

struct FacePiece {
  Vec2 middle;                 ///< a point inside
  double fraction;             ///< part of the triangle's area
  std::array<Vec2, 4> corners; ///< counter-clockwise; two of a triangle's are the same
};

/// Cuts the triangle a, b, c, which must have area, into trapezoids and triangles such that no segment passes through the
/// inside of one: by horizontals through every end of a segment and every crossing of two. Segments may leave the triangle.
/// Pieces below 1e-14 of the area are left out. Time grows with the segments squared where many lie at one height.
void for_each_piece(const Vec2& a, const Vec2& b, const Vec2& c, std::span<const Segment2> segments,
                    const std::function<void(const FacePiece& piece)>& each);

} // namespace cowgpu
