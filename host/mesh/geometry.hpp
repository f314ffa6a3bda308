// Size, place and shape of a body bounded by triangles: sums of signed tetrahedra.
//
// Lengths are in the mesh's own unit, areas in its square, volumes in its cube. All sums run in extended precision
// (long double, and Quad where they cancel: geometry/determinant.hpp) relative to the middle of the bounding box, and are
// rounded once: bodies that are thin, hollow or far from the origin lose nothing. The order of the faces is the order of
// summation: results repeat bit for bit.
//
// The functions on spans take any valid indices and say what they mean for surfaces that are not closed; with
// coordinates that are not finite the result is NaN.
#pragma once

#include "host/mesh/closed_surface.hpp"

#include <span>

namespace cowgpu {

/// An axis-parallel box.
struct Box {
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();
  Vec3 middle() const { return min / 2 + max / 2; }
  double longest_side() const { return (max - min).maxCoeff(); }
};

/// The bounding box of the vertices that belong to a face; at the origin and of no size if there is no face.
Box bounding_box(std::span<const Vec3> vertices, std::span<const Face> faces);

/// The signed volume: the sum over faces of det(a, b, c)/6 relative to the box's middle (divergence theorem). Regions
/// count by the surface's winding number about them. For an open surface the value depends on that middle.
double volume(std::span<const Vec3> vertices, std::span<const Face> faces);

/// The sum of the faces' areas, overlaps and cavities included.
double area(std::span<const Vec3> vertices, std::span<const Face> faces);

/// The centre of mass at uniform density: sum of det(a, b, c)/6 (a + b + c)/4 over the volume. NaN if the volume is 0.
Vec3 centre_of_mass(std::span<const Vec3> vertices, std::span<const Face> faces);

/// What rounding the coordinates once can add to a volume: area times 2^-52 times the largest |coordinate| of a used
/// vertex. A smaller volume cannot be told from zero (a flat surface that was rotated has one).
double volume_noise(std::span<const Vec3> vertices, std::span<const Face> faces);

/// The largest distance of a vertex that belongs to a face from `origin`: the radius of the Brillouin sphere. 0 without
/// faces.
double brillouin_radius(std::span<const Vec3> vertices, std::span<const Face> faces, const Vec3& origin);

inline Box bounding_box(const ClosedSurface& s) {
  return bounding_box(s.vertices(), s.faces());
}
inline double volume(const ClosedSurface& s) {
  return volume(s.vertices(), s.faces());
}
inline double area(const ClosedSurface& s) {
  return area(s.vertices(), s.faces());
}
inline Vec3 centre_of_mass(const ClosedSurface& s) {
  return centre_of_mass(s.vertices(), s.faces());
}
inline double brillouin_radius(const ClosedSurface& s, const Vec3& origin) {
  return brillouin_radius(s.vertices(), s.faces(), origin);
}

/// The signed volume of each shell (see topology.hpp), relative to the middle of the whole box, and its area.
struct ShellSize {
  double volume = 0, area = 0;
};
std::vector<ShellSize> shell_sizes(std::span<const Vec3> vertices, std::span<const Face> faces,
                                   std::span<const std::uint32_t> shell, std::size_t count);

} // namespace cowgpu
