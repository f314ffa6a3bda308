// How far two surfaces are apart.
#pragma once

#include "host/monitor.hpp"
#include "host/types.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace cowgpu {

/// Distances of points of one surface from the nearest point of the other, in mesh length units.
struct OneWayDistance {
  double largest = 0;        ///< over the samples and the vertices in use
  double rms = 0;            ///< over the samples, so by area
  Vec3 where = Vec3::Zero(); ///< the point of the first surface where the largest was found
};

struct SurfaceDistance {
  OneWayDistance forth; ///< distance of the first surface from the second
  OneWayDistance back;  ///< distance of the second surface from the first
  double largest() const;
  double rms() const; ///< root of the mean of both squares
};

/// `count` points that share the area evenly: sample k lies on the triangle that holds the part (k + 1/2) / count of the
/// area in the order of the faces, at a place of the R2 sequence (M. Roberts). Repeats bit for bit. Empty for a surface
/// without area. Indices must be valid.
std::vector<Vec3> area_samples(std::span<const Vec3> vertices, std::span<const Face> faces, std::size_t count);

/// Both ways by `samples` points each, on `threads` threads (0: all) of the CPU path of `closest`. `rms` has a sampling error of about rms / sqrt
/// (samples); `largest` is a lower bound. O(samples log faces). Throws Error(mesh_empty) for a surface without faces or
/// without area, mesh_not_finite, interrupted. Indices must be valid.
SurfaceDistance surface_distance(std::span<const Vec3> vertices, std::span<const Face> faces,
                                 std::span<const Vec3> other_vertices, std::span<const Face> other_faces,
                                 std::size_t samples, unsigned threads, Monitor& monitor);

} // namespace cowgpu
