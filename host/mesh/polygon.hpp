// Polygons with corners in space, cut into triangles.
#pragma once

#include "host/types.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu {

/// What became of a polygon.
enum class PolygonCut {
  fan,      ///< the fan from its first corner is right: (0, 1, 2), (0, 2, 3) ...
  cut,      ///< cut otherwise
  touches,  ///< refused: two corners that do not follow each other lie at one place
  crosses,  ///< refused: two edges cross or touch, or the boundary turns back on itself
  no_plane, ///< refused: all corners on one line, or too bent to have a plane in which it is simple
};

struct CutPolygon {
  PolygonCut result = PolygonCut::fan;
  std::array<std::uint32_t, 2> at{}; ///< `touches`: the corners; `crosses`: the corners where the edges begin
  /// The largest distance of a corner from the polygon's plane, over the longest side of its bounding box; 0 where it is flat
  /// within 1e-6 of that and the rounding of coordinates to float.
  double bend = 0;
};

/// Cuts polygons of n corners into n - 2 triangles that keep the polygon's edges and its sense of turning, and name every corner:
/// a mesh that was closed stays closed. Keeps its room between polygons.
///
/// The plane is that of the area vector (Newell's sum of cross products), seen along the axis that is steepest to it; there
/// every decision is an exact sign (geometry/orientation.hpp). The fan from the first corner is kept where it covers the polygon once
/// and has no triangle without area that another cut would avoid; this includes all strictly convex polygons. Any other
/// polygon is swept once by increasing coordinate, which proves it simple (M. I. Shamos, D. Hoey, Proc. 17th FOCS (1976) 208)
/// and cuts it (S. Hertel, K. Mehlhorn, Proc. FCT (1983) 207): triangles have exactly positive areas, corners of 180 degrees
/// included. Then diagonals are flipped towards the Delaunay triangulation of the polygon (C. L. Lawson, 1977), which avoids
/// thin triangles where corners lie on a line within rounding. Corners that follow each other at one place are one corner,
/// with triangles without area between them. A bent polygon has no one surface: it is cut as it looks along that axis; one of
/// four corners that crosses itself there, bent by more than 0.01, keeps its fan.
///
/// Work: O(n log n) signs, and at most 64 n flips. Memory: some 200 n bytes, beyond the fan only.
class PolygonCutter {
public:
  /// `corners` has three or more; they are finite, or the fan is returned unseen. After `cut`, triangles() has the corners.
  CutPolygon cut(std::span<const Vec3> corners);

  const std::vector<Face>& triangles() const { return triangles_; }

private:
  std::vector<std::uint32_t> distinct_; ///< corners that do not lie where the one before them does
  std::vector<Face> triangles_;
};

} // namespace cowgpu
