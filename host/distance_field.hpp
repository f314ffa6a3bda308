// The verb `closest`: for points, the nearest point of a triangle surface and the signed distance from it.
#pragma once

#include "host/kernel_time.hpp"
#include "host/memory_need.hpp"
#include "host/monitor.hpp"
#include "host/types.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace cowgpu {

/// The part of a surface a closest point lies on. Faces that meet there agree on it, so it is what paths are compared by.
struct SurfaceFeature {
  enum class Kind : std::uint8_t { vertex, edge, face };
  Kind kind = Kind::face;
  std::uint32_t first = 0;  ///< the vertex; of an edge its lower vertex; the face
  std::uint32_t second = 0; ///< an edge's higher vertex, else as `first`

  bool operator==(const SurfaceFeature&) const = default;
};

/// "vertex", "edge", "face".
std::string_view name(SurfaceFeature::Kind kind);

/// A closest point.
struct SurfacePoint {
  double distance = 0;             ///< from the query, not negative
  Vec3 point = Vec3::Zero();       ///< mesh coordinates
  std::uint32_t face = 0;          ///< the least of the faces that hold `feature`
  Vec3 barycentric = Vec3::Zero(); ///< coordinates of `point` in `face`, not negative; exact zeros off the feature
  SurfaceFeature feature;
};

/// Stands for no face.
inline constexpr std::uint32_t no_face = 0xffffffffU;

struct ClosestOptions {
  /// With the winding number and the sign it gives; the surface must be closed then.
  bool with_sign = true;
};

/// One entry a query, in the order of the queries.
struct ClosestPoints {
  std::vector<double> distance;        ///< positive outside, negative inside; without sign: not negative
  std::vector<Vec3> point;             ///< mesh coordinates
  std::vector<std::uint32_t> face;     ///< as SurfacePoint has them
  std::vector<Vec3> barycentric;       //
  std::vector<SurfaceFeature> feature; //
  std::vector<std::int32_t> winding;   ///< winding number of the surface about the query; empty without sign

  std::size_t size() const { return distance.size(); }
};

/// What a call took, beside its result.
struct ClosestReport {
  double seconds = 0;              ///< wall time of the call
  double sort_seconds = 0;         ///< the part of `seconds` that ordered the queries
  std::uint64_t rays = 0;          ///< queries whose winding number took a ray (the others share a neighbour's)
  std::vector<KernelTime> kernels; ///< empty on the CPU path
};

/// A triangle surface, prepared once for many queries: trees are built by prepare(), or by the first call. The surface's
/// vertices and faces must live until then.
///
/// Distances and points are those of the triangles as sets of points: edges and corners belong to them, and triangles
/// without area are segments or points. Errors are about 2e-16 of the surface's diagonal or of the distance, whichever is
/// more. Of triangles that are equally near, as far as rounding tells, one is taken by the double-precision distance; on an
/// edge or a vertex the least face that holds it is named, so neither threads nor the other queries change a result.
///
/// Inside means that the surface winds about the point a positive number of times: the number of faces above it whose
/// outer side looks up less those whose outer side looks down, counted with exact signs. Where a body overlaps itself the
/// number is 2, in a bubble of it turned inside out -1, which is outside. Points of the surface itself have distance 0 and
/// the winding number of either side.
///
/// Queries in any order: they are sorted along a Morton curve for the work. Not for several threads at once.
class DistanceField {
public:
  virtual ~DistanceField() = default;

  /// Upper bound of what the field and a call with so many queries allocate, the result included. It reads the sizes of the
  /// surface alone.
  virtual MemoryNeed memory(std::uint64_t queries) const = 0;
  /// Builds the trees unless they are there. Throws what check_distance_surface throws, too_large, device_failed, device_lost.
  virtual void prepare() = 0;

  /// Throws what prepare() throws, Error(bad_argument) for a query with a coordinate that is not finite or beyond 1e100, mesh_open for a signed
  /// distance from a surface whose edges are not run as often one way as the other, too_large, device_failed, device_lost,
  /// interrupted. Takes 76 bytes a query for the result and 20 for the order.
  virtual ClosestPoints closest(std::span<const Vec3> queries, const ClosestOptions& options, Monitor& monitor,
                                ClosestReport* report = nullptr) = 0;
};

/// Throws Error(mesh_empty, mesh_index_range, mesh_not_finite, mesh_range) for a surface no distance can be measured from;
/// coordinates in use may be up to 1e100, and the longest side of its box 0 or at least 1e-100.
void check_distance_surface(std::span<const Vec3> vertices, std::span<const Face> faces);

/// Throws Error(bad_argument) as DistanceField::closest does.
void check_queries(std::span<const Vec3> queries);

} // namespace cowgpu
