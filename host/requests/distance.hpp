// Distances of points from a surface.
#pragma once

#include "host/backend.hpp"
#include "host/report/distance_report.hpp"

#include <optional>

namespace cowgpu {

struct DistanceRequest {
  RawMesh mesh;
  std::vector<Vec3> points; ///< in mesh coordinates
  /// Instead of `points` a lattice, with so many points (2 at least) along the longest side of the bounding box, which is
  /// enlarged by lattice_enlargement.
  std::optional<std::size_t> lattice;
  bool with_sign = true; ///< negative inside; the surface must be closed then
  unsigned threads = 0;  ///< threads that look for what is odd about the mesh; 0: all
};

/// A request whose mesh is checked, and what it takes.
struct DistancePlan {
  /// Throws what ClosedSurface::from() throws, without sign what check_distance_surface() throws.
  DistancePlan(DistanceRequest request, Monitor& monitor);

  DistanceResult result; ///< without what is computed, and without the queries of a lattice
  std::size_t count = 0; ///< points

  /// What find_distances() needs at most, an image of the result as a file among it.
  MemoryNeed memory(const Backend& backend) const;
};

/// Throws Error(too_large) where this machine has less memory than that.
void check_distance_memory(const DistancePlan& plan, const Backend& backend);

/// Throws the same, and what DistanceField throws.
DistanceResult find_distances(DistancePlan plan, Backend& backend, Monitor& monitor);

} // namespace cowgpu
