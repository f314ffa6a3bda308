// The verb `polyhedron`: the exact field of a body of uniform density, inside, outside and on its surface.
#pragma once

#include "host/memory_need.hpp"
#include "host/monitor.hpp"
#include "host/potential.hpp"
#include "host/run_report.hpp"
#include "host/types.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu {

/// Across a face second derivatives jump by 4 pi n n, and the winding number by 1: their values at points on a face.
enum class FaceSide {
  mean,  ///< the mean of both sides' limits
  outer, ///< the limit from where the face's normal points
  inner, ///< the limit from the other side
};

/// Range of PolyhedronProblem::tolerance where it is not 0.
inline constexpr double least_polyhedron_tolerance = 1e-12, largest_polyhedron_tolerance = 1e-2;

/// What is asked for of V(x) = integral of 1/|x - y| over the inside of a closed surface of triangles, each point y counted
/// as often as the surface winds about it. Vertices and faces must outlive what is prepared of them.
struct PolyhedronProblem {
  std::span<const Vec3> vertices;
  std::span<const Face> faces; ///< counter-clockwise seen from outside; faces without area have no field
  Derivatives derivatives = Derivatives::first;
  FaceSide side = FaceSide::mean;
  /// 0: all faces are summed, right to rounding. Else groups of faces far away are summed by their multipoles where that takes
  /// less time, on a device as on the CPU. The error of the gradient is meant to stay below this part of v/R^2 at each point, v the
  /// volume and R the radius of the ball with that volume, and that of V below the same times the radius of the body, which is R
  /// of a ball and far more of a thin body: so it was at each place of the bodies that were tried (bench/polyhedron_fast.md);
  /// without the guarantee nothing is proven.
  double tolerance = 0;
  /// What the multipoles leave out of the gradient is proven to be below the tolerance at each point, and each point's bound is
  /// given. Covers neither rounding nor V.
  bool guarantee = false;
};

/// One entry a point, in their order.
struct PolyhedronValues {
  PotentialField field;        ///< in the mesh's unit squared, its gradient in units, second derivatives without unit
  std::vector<double> winding; ///< winding number about the point: -(trace of the second derivatives)/4 pi
  std::vector<double> bound;   ///< where it is guaranteed: of the gradient's truncation; empty elsewhere
  /// 1 on edges and vertices (where the faces that meet there are not coplanar), whose second derivatives are infinite: what
  /// is given there leaves the edge out. Empty where no second derivatives were asked for.
  std::vector<std::uint8_t> on_edge;
};

/// A polyhedron, ready for any number of calls.
class PreparedPolyhedron {
public:
  virtual ~PreparedPolyhedron() = default;

  /// Upper bound of what at() allocates for so many points, its result included.
  virtual MemoryNeed memory(std::uint64_t points) const = 0;

  /// At points in mesh coordinates. Throws Error(bad_argument) for points that are not finite and for a tolerance out of range,
  /// too_large, device_failed, device_lost, interrupted. The same points on the same device give the same bits, with any number
  /// of threads. Of the report, seconds, setup_seconds, elements (pairs of a face and a point), full_elements (faces times
  /// points) and kernels are set, by the fast sum pairs of cells and their multiply_adds too.
  virtual PolyhedronValues at(std::span<const Vec3> points, Monitor& monitor, RunReport* report = nullptr) const = 0;
};

} // namespace cowgpu
