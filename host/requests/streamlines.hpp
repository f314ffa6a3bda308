// Streamlines of the distance's flow off the cut of a body with a plane.
#pragma once

#include "host/backend.hpp"
#include "host/report/streamlines_report.hpp"

#include <optional>

namespace cowgpu {

struct StreamlinesRequest {
  RawMesh mesh;
  Plane plane;
  Vec3 origin = Vec3::Zero();  ///< where the directions of the ends are seen from, in mesh coordinates
  std::optional<double> time;  ///< how long to flow, which is a length; nothing: the box's diagonal
  std::size_t count = 200;     ///< lines, evenly spaced along the cut
  std::optional<double> space; ///< instead of `count`: how far apart the lines start
  /// Instead of both: start at the mesh's vertices that are no farther than this from the plane.
  std::optional<double> within;
  double tolerance = FlowOptions{}.tolerance; ///< error allowed per time on the medial axis
  unsigned threads = 0;                       ///< threads that look for what is odd about the mesh; 0: all
};

/// Throws Error(mesh_empty) where the plane misses the mesh or no vertex is near it, bad_argument for more than
/// most_streamlines lines and a time out of range, and what ClosedSurface::from() and DistanceFlow throw.
StreamlinesResult find_streamlines(StreamlinesRequest request, Backend& backend, Monitor& monitor);

} // namespace cowgpu
