// The stage `sample`, what both paths share: which triangles can be hit, where on each ring, who decides what a filter
// leaves open, and the place on a triangle.
//
// The triangle a, b, c of unit vectors owns the cone alpha a + beta b + gamma c with no coefficient negative, its edges
// and corners included. With the orientation sigma = sign det(a, b, c), a direction d is in it if and only if
//   sigma det(d, b, c) >= 0,  sigma det(d, c, a) >= 0,  sigma det(d, a, b) >= 0,
// and these are the coefficients up to a common factor: the ray through d meets the plane of the chord triangle at
// barycentric coordinates proportional to them. Signs are those of the exact determinants of the doubles, so that
// triangles that share an edge leave no gap: the triangles of a closed mesh cover every direction if the map's degree is
// not zero. Triangles with det(a, b, c) = 0 own nothing; the others cover every direction all the same, since what they
// cover together is closed and the rest would be open and inside edges.
#pragma once

#include "host/sphere_directions.hpp"
#include "host/sphere_samples.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// |det(d, a, b)| above this is larger than every rounding error of n . d, n = a x b, for vectors no longer than 1 + 1e-9
/// in double arithmetic without fused operations: five roundings of 2^-53 reach a term, and the terms' moduli add up to
/// at most sqrt(4/3).
inline constexpr double sample_filter = 1e-15;

/// Consecutive points of a ring that a triangle may own; none crosses longitude 0.
struct RingSpan {
  int first = 0, count = 0;
};

/// A triangle that may be hit.
struct SampleFace {
  std::uint32_t face = 0; ///< index in the mesh
  bool flipped = false;
  int first_ring = 0, last_ring = 0; ///< that may be hit
};

/// A triangle with its corners so ordered that det > 0: a, c, b for a flipped one.
struct SampleCorners {
  Vec3 a, b, c;
};

enum class Place { outside, edge, inside };

struct Sample {
  /// Keeps references to all three. Throws Error(bad_argument) for a face that names no position, for positions of faces
  /// that are not unit vectors to 1e-9, and for 2^31 faces or more.
  Sample(std::span<const Vec3> positions, std::span<const Face> faces, const SphereGrid& grid, unsigned threads);

  SampleCorners corners(std::size_t rank) const;
  /// Exactly.
  Place place(std::size_t rank, const Vec3& direction) const;
  /// Ranks of the triangles that may hit each band of `rings` rings, ascending.
  std::vector<std::vector<std::uint32_t>> bands(int rings) const;
  /// Throws Error(map_failed) for the lowest of `uncovered` points that nobody owns.
  [[noreturn]] void refuse(std::size_t point, std::uint64_t uncovered) const;
  /// An empty result of the right size.
  SphereSamples samples() const;

  std::span<const Vec3> positions;
  std::span<const Face> faces;
  const SphereGrid& grid;
  SphereDirections directions;
  std::vector<SampleFace> kept; ///< in the order of the key (flipped, face): its index is the rank
  std::uint64_t flipped_faces = 0, flat_faces = 0;
};

/// Where a triangle's bounding cap and the planes of its edges meet the rings of a grid.
class RingScan {
public:
  RingScan(const Sample& sample, std::size_t rank);

  /// The points of a ring that the triangle may own, a few more than it does; returns how many spans there are.
  int spans(int ring, std::array<RingSpan, 2>& spans) const;
  /// Inward normals b x c, c x a, a x b.
  const std::array<Vec3, 3>& normals() const { return normals_; }

private:
  const Sample& sample_;
  std::array<Vec3, 3> normals_;
  std::array<double, 3> normal_rho_, normal_phi_; // distance from the axis, longitude
  double theta_, phi_, sine_;                     // angles and sine of theta of the cap's centre
  double half_sine2_;                             // sin^2 of half its angle
};

/// A cap that holds a spherical triangle; angle 4 (more than pi) if it is the whole sphere.
struct Cap {
  Vec3 centre;
  double angle;
};
Cap bounding_cap(const Vec3& a, const Vec3& b, const Vec3& c);

/// Barycentric coordinates of the point where the ray through d meets the plane of a, b, c, for d in the cone: by
/// det(d, b, c) = d . ((b - d) x (c - d)), which keeps the digits of small triangles and changes nothing but its sign
/// when two corners are exchanged. shaders/sample_weights.comp does the same operations in the same order.
inline std::array<double, 3> barycentric(const Vec3& d, const SampleCorners& corners) {
  const double ax = corners.a.x() - d.x(), ay = corners.a.y() - d.y(), az = corners.a.z() - d.z();
  const double bx = corners.b.x() - d.x(), by = corners.b.y() - d.y(), bz = corners.b.z() - d.z();
  const double cx = corners.c.x() - d.x(), cy = corners.c.y() - d.y(), cz = corners.c.z() - d.z();
  double u = (d.x() * (by * cz - bz * cy) + d.y() * (bz * cx - bx * cz)) + d.z() * (bx * cy - by * cx);
  double v = (d.x() * (cy * az - cz * ay) + d.y() * (cz * ax - cx * az)) + d.z() * (cx * ay - cy * ax);
  double w = (d.x() * (ay * bz - az * by) + d.y() * (az * bx - ax * bz)) + d.z() * (ax * by - ay * bx);
  u = u > 0 ? u : 0;
  v = v > 0 ? v : 0;
  w = w > 0 ? w : 0;
  const double sum = (u + v) + w;
  if (!(sum > 0)) return {1.0 / 3, 1.0 / 3, 1.0 / 3}; // so small that the determinants underflow
  return {u / sum, v / sum, w / sum};
}

} // namespace cowgpu::plan
