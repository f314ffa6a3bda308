// Distances from a surface, in files. The layouts below are fixed: later versions may add columns, variables and attributes.
//
// CSV: lines "# key value" (cowgpu, mesh, sha256, signed yes|no), then the names
//   x,y,z,distance,closest_x,closest_y,closest_z,face,b0,b1,b2,feature,feature_first,feature_second,winding
// and one row a point in the order of the input. b0, b1, b2 are barycentric coordinates in `face`; feature is vertex, edge or
// face, with its indices (SurfaceFeature); winding is missing without sign.
// netCDF (netCDF-4): of points, dimension point and double x(point), y(point), z(point); of a lattice, dimensions z, y, x with
// coordinate variables of their own names. Over (point) or (z, y, x): double distance, closest_x, closest_y, closest_z, b0,
// b1, b2; int64 face, feature (0 vertex, 1 edge, 2 face), feature_first, feature_second, winding.
// Lengths are in the mesh's unit, units "1" in netCDF. Distances are positive outside.
#pragma once

#include "host/distance_field.hpp"
#include "host/io/atomic_file.hpp"
#include "host/io/file_format.hpp"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace cowgpu {

/// Points with one spacing along all axes; x varies fastest.
struct PointLattice {
  Vec3 first = Vec3::Zero();
  double spacing = 0;
  std::array<std::size_t, 3> counts{};

  std::size_t size() const { return counts[0] * counts[1] * counts[2]; }
  double coordinate(int axis, std::size_t i) const { return first[axis] + double(i) * spacing; }
  std::vector<Vec3> points() const;
};

/// `along_longest` points, at least 2, along the longest side of the box [low, high] enlarged by `factor` about its middle,
/// both ends included; as many along the others as cover them.
PointLattice lattice_about(const Vec3& low, const Vec3& high, double factor, std::size_t along_longest);

/// What a file of distances holds. References stay the caller's.
struct DistanceTable {
  std::string mesh, sha256;
  std::span<const Vec3> queries;
  const ClosestPoints& points;
  std::optional<PointLattice> lattice; ///< where the queries are one
};

void write_distances_csv(const DistanceTable& table, const std::function<void(std::string_view)>& sink);

/// Writes either format; commit() is left to the caller. Throws Error(cannot_write, too_large).
void write_distances(const DistanceTable& table, FileFormat format, AtomicFile& file);

} // namespace cowgpu
