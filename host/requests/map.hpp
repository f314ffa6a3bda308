// A body's map to the sphere, and what the map is worth.
#pragma once

#include "host/map/harmonic.hpp"
#include "host/map/smooth.hpp"
#include "host/map/stretch.hpp"
#include "host/mesh/body.hpp"
#include "host/monitor.hpp"
#include "host/report/map_report.hpp"

#include <optional>
#include <variant>

namespace cowgpu {

/// The mesh's vertices where the distance's flow brings them, seen from the origin. Such a map may fold over itself.
struct FlowMapOptions {
  std::optional<double> time; ///< how long to flow, in the mesh's length unit; nothing: until the body is star-shaped
  OriginChoice origin;
};

struct MapRequest {
  RawMesh mesh; ///< closed, one manifold of genus 0
  std::variant<StretchOptions, HarmonicOptions, SmoothOptions, FlowMapOptions> method;
  unsigned relabellings =
      0;                ///< copies of the body, numbered and turned at random, on which the stretch map is made again
  int lmax = 512;       ///< degree of the grid that the map is judged against
  unsigned threads = 0; ///< 0: all
};

/// Maps on the CPU, for which no device has a kernel, and judges. Throws Error(bad_argument) for numbers beyond
/// host/requests/limits.hpp, what ClosedSurface::from(), ManifoldSurface::from(),
/// require_sphere() and the maps throw.
MapResult make_map(MapRequest request, Monitor& monitor);

/// Throws Error(map_failed) for a map that does not cover the sphere once: it is fit for nothing.
void check_map(const MapResult& result);

} // namespace cowgpu
