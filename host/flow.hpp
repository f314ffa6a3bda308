// The flow of the distance's gradient: nouns of the verb `flow`.
//
//   d x / dt = grad d(x),  d the distance from a body's surface, negative inside (winding number above 0).
//
// Outside, the curves are straight rays of unit speed until the nearest point is no longer one; from there they slide
// along the medial axis with the generalised gradient, the vector of least norm in the convex hull of the unit vectors
// from all nearest points (Lieutier, Computer-Aided Design 36 (2004) 1029). Lengths and times are in the mesh's unit.
#pragma once

#include "host/kernel_time.hpp"
#include "host/memory_need.hpp"
#include "host/monitor.hpp"
#include "host/types.hpp"

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace cowgpu {

struct FlowOptions {
  double time = 0;         ///< t >= 0 to flow for
  double tolerance = 1e-6; ///< error allowed per time on the medial axis, 1e-12 to 1e-2; rays are exact
  /// Against the gradient, from outside: along the ray to the nearest surface point, and no further than it.
  bool backward = false;
  bool streamlines = false; ///< keep the corners of each path
};

/// What befell a point; bits of FlowPoints::flags.
enum FlowFlag : std::uint8_t {
  flow_slid = 1,        ///< reached the medial axis
  flow_stationary = 2,  ///< ended where the generalised gradient is 0: it stays there for ever
  flow_inside = 4,      ///< started inside the body: it came out by the nearest face that leads out
  flow_restarted = 8,   ///< integrated again at a tighter tolerance
  flow_unfinished = 16, ///< neither way came to the end: its position is where it got stuck
  flow_surface = 32,    ///< backward: it reached the surface
  flow_notch = 64,      ///< started where no ray leaves (a saddle, a reflex edge): 1e-7 of the diagonal off the surface
};

/// One entry a start, in their order.
struct FlowPoints {
  std::vector<Vec3> positions;        ///< at the end
  std::vector<double> distances;      ///< d there, signed
  std::vector<std::uint32_t> faces;   ///< a nearest face there
  std::vector<std::uint8_t> flags;    ///< bits of FlowFlag
  std::vector<double> slide_times;    ///< times of first reaching the medial axis; infinite if never
  std::vector<Vec3> slide_places;     ///< where that was
  std::vector<std::uint32_t> queries; ///< nearest-face queries spent
  /// Path of start i: corners first[i] ... first[i + 1] - 1 of path and path_times. Empty if not asked for.
  std::vector<std::size_t> first;
  std::vector<Vec3> path;
  std::vector<double> path_times;
};

/// Counts over all starts.
struct FlowReport {
  std::uint64_t points = 0, slid = 0, stationary = 0, inside = 0, restarted = 0, unfinished = 0;
  std::uint64_t queries = 0, events = 0, steps = 0; ///< nearest faces asked for, changes of contacts, steps of slides
  double first_slide = std::numeric_limits<double>::infinity(), median_slide = 0; ///< times of reaching the axis
  Vec3 slide_low = Vec3::Zero(), slide_high = Vec3::Zero(); ///< box round the places where slides start
  double seconds = 0;
  std::uint64_t passes = 0;         ///< passes of the device over all points on their way; 0 on the CPU path
  std::uint64_t device_queries = 0; ///< the queries that the device answered
  std::uint64_t device_moves = 0;   ///< the answers from which the device took the point on
  std::vector<KernelTime> kernels;  ///< empty on the CPU path
};

/// A closed surface to flow off, prepared once for many flows: trees are built by prepare(), or by the first call. The
/// surface's vertices and faces must live until then. Not for several threads at once.
class DistanceFlow {
public:
  virtual ~DistanceFlow() = default;

  /// Upper bound of what the surface's trees and a flow of so many starts allocate, the result included, streamlines not. It
  /// reads the sizes of the surface alone.
  virtual MemoryNeed memory(std::uint64_t starts) const = 0;
  /// Builds the trees unless they are there. Throws what DistanceField::prepare throws, and mesh_open.
  virtual void prepare() = 0;

  /// Flows every start. `normals` is empty, or holds one vector a start: where it is not zero, the start lies on the
  /// surface and leaves along it (unit length; angle-weighted at edges and vertices: at a convex one every direction of
  /// the normal cone is a solution, at others the flow leaves what is not). Starts without one that lie on the surface
  /// leave along a nearest face's normal. Backward takes no normals.
  ///
  /// Throws what prepare() throws, Error(bad_argument) for options out of range or starts that are not finite, interrupted. The same input gives
  /// the same bits on any number of threads.
  virtual FlowPoints flow(std::span<const Vec3> starts, std::span<const Vec3> normals, const FlowOptions& options,
                          Monitor& monitor, FlowReport* report = nullptr) = 0;
};

} // namespace cowgpu
