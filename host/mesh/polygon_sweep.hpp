// One sweep over a polygon in the plane: proves it simple and cuts it.
#pragma once

#include "host/types.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace cowgpu {

/// A polygon as it looks along an axis: places are compared by two coordinates, exactly.
class FlatPolygon {
public:
  /// `corners` name points; `mirrored` looks from the axis's negative end.
  FlatPolygon(std::span<const Vec3> points, std::span<const std::uint32_t> corners, int axis, bool mirrored)
      : points_(points), corners_(corners), first_((axis + (mirrored ? 2 : 1)) % 3),
        second_((axis + (mirrored ? 1 : 2)) % 3) {}

  std::uint32_t size() const { return static_cast<std::uint32_t>(corners_.size()); }
  std::uint32_t next(std::uint32_t i) const { return i + 1 == size() ? 0 : i + 1; }
  std::uint32_t previous(std::uint32_t i) const { return i == 0 ? size() - 1 : i - 1; }

  /// Whether corner i is swept before corner j: by the first coordinate, then by the second.
  bool before(std::uint32_t i, std::uint32_t j) const;
  bool same_place(std::uint32_t i, std::uint32_t j) const;
  /// The sign of the area of the triangle i, j, k: 1 counter-clockwise.
  int turn(std::uint32_t i, std::uint32_t j, std::uint32_t k) const;

private:
  const Vec3& point(std::uint32_t i) const { return points_[corners_[i]]; }

  std::span<const Vec3> points_;
  std::span<const std::uint32_t> corners_;
  int first_, second_;
};

/// Where a polygon is not simple: two corners at one place, or the corners where two edges that meet begin.
struct NotSimple {
  bool touches = false;
  std::array<std::uint32_t, 2> at{};
};

/// Appends the n - 2 triangles of a counter-clockwise polygon of three corners or more, each of positive area, to `triangles`,
/// corners counted as in `polygon`. Returns where it is not simple; `triangles` then means nothing. O(n log n).
std::optional<NotSimple> sweep(const FlatPolygon& polygon, std::vector<Face>& triangles);

/// Whether a simple polygon runs counter-clockwise: by the turn at the corner that is swept first; 0 where it turns back there.
int sense_of(const FlatPolygon& polygon);

/// Flips diagonals until every one is Delaunay in the plane of `places` (by corner), at most 64 flips a triangle. Flips keep
/// the signs of areas in `polygon` positive.
void flip_towards_delaunay(const FlatPolygon& polygon, std::span<const std::array<double, 2>> places,
                           std::vector<Face>& triangles);

} // namespace cowgpu
