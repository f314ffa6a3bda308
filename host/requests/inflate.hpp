// A body inflated by a distance, and the least distance that makes it star-shaped about a point.
#pragma once

#include "host/backend.hpp"
#include "host/report/inflate_report.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace cowgpu {

struct InflateRequest {
  RawMesh mesh;
  OriginChoice origin; ///< star-shaped about this point
  /// Distances to inflate by, each from 1e-4 to 1e4 of the box's longest side, in the mesh's length unit; nothing: the least
  /// that is surely enough for a star-shaped body.
  std::vector<std::optional<double>> levels;
  bool star = false;    ///< find that least distance even where no level needs it; without levels it is always found
  int cells = 128;      ///< cubes along the longest side of the box in which a level is looked for, 4 to 1024
  unsigned threads = 0; ///< threads that look for what is odd about the mesh; 0: all
};

/// What that needs at most; nothing without levels, since the search for the least distance needs little.
MemoryNeed inflate_memory(const InflateRequest& request, const Backend& backend);

/// Inflates, level by level; `done` gets each body as soon as it is there, and may name it. Throws what ClosedSurface::from() and make_body()
/// throw for the mesh, Error(bad_argument) for a level out of its range and for a star-shaped body's least distance as a
/// level, too_large, and what star_shape_time() and level_surface() throw.
InflateResult inflate(InflateRequest request, Backend& backend, Monitor& monitor,
                      const std::function<void(InflatedBody&)>& done = {});

} // namespace cowgpu
