// The stage `polyhedron`, what both paths share of a call: the order of faces and of points, and which points are far away.
//
// The closed form is a difference of large numbers far from the body: of the gradient a part of (distance/size)^2 units in the
// last place is lost. Points farther from the middle than far_radii of the body's ball are left to the multipoles about it, of
// which degrees above far_degree add less than far_radii^-(far_degree + 1) = 2e-18.
#pragma once

#include "host/multipoles.hpp"
#include "host/plan/polyhedron.hpp"
#include "host/polyhedron.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

inline constexpr double far_radii = 3;
inline constexpr int far_degree = 36;

/// Faces of a patch of the direct sum, and points that are summed together.
inline constexpr std::size_t direct_patch = 64, direct_block = 64;

/// A surface, and its faces along a curve in space in patches of direct_patch.
struct PolyhedronSurface {
  double unit = 1;            ///< polyhedron_unit()
  double touching = 0;        ///< touching_distance(), in the mesh's unit
  Vec3 middle = Vec3::Zero(); ///< of the box of the vertices
  double radius = 0;          ///< largest distance of a vertex from there
  std::vector<std::uint32_t> order, starts;
  std::vector<std::uint8_t> sharp; ///< sharp_edges(), where second derivatives are asked for

  PatchFaces patches() const { return {order, starts, {}, sharp}; }
};
PolyhedronSurface polyhedron_surface(const PolyhedronProblem& problem, unsigned threads);

/// The points of a call.
struct PolyhedronPoints {
  std::vector<std::uint32_t> near; ///< neighbours in space next to each other
  std::vector<std::uint32_t> far;  ///< farther than far_radii
};
/// Throws Error(bad_argument) for a point that is not finite, too_large for more than 2^31.
PolyhedronPoints polyhedron_points(const PolyhedronSurface& surface, std::span<const Vec3> points, unsigned threads);

/// The moments that the far points need; 1 for the radius of a body without extent.
MomentProblem far_moments(const PolyhedronProblem& problem, const PolyhedronSurface& surface);

/// The far points as seen from the middle.
std::vector<Vec3> far_places(const PolyhedronSurface& surface, std::span<const Vec3> points,
                             std::span<const std::uint32_t> far);

/// Room for the values of so many points: zeros.
PolyhedronValues polyhedron_values(const PolyhedronProblem& problem, std::size_t points);

/// Sums of one point in units: rows of PolyhedronRows, `stride` apart.
void store_sums(const PolyhedronProblem& problem, double unit, const double* sums, std::size_t stride,
                std::size_t point, PolyhedronValues& values);
/// The field of the far points.
void store_far(const PotentialField& field, std::span<const std::uint32_t> far, PolyhedronValues& values);

/// Upper bound of the bytes of the surface, the points and the values, without the far field.
std::uint64_t polyhedron_call_bytes(const PolyhedronProblem& problem, std::uint64_t points);

} // namespace cowgpu::plan
