// The stage `polyhedron`, what both paths share: a closed surface's faces in patches, ready for closed forms.
//
// With G = density = 1, r = y - x from the point x to y, n a face's outward normal, h = n.r (the same at all of the face),
// m_k the outward normal of its edge k in its plane, s_k = m_k.r at that edge, a and b the distances of an edge's ends, e its
// length, the integral over a face f of 1/|r| is
//   phi = sum_k s_k L_k - h w,   L_k = ln((a + b + e)/(a + b - e)),
// w its solid angle, positive where the normal points away from x:
//   tan(w/2) = 4 A h / D,   D = a u_bc + b u_ca + c u_ab - 4 a b c,   u_ab = (a + b - e)(a + b + e),
// A the area and a, b, c the distances of the corners. Then (Werner and Scheeres 1997, gathered by faces)
//   V = 1/2 sum_f h phi,   grad V = -sum_f n phi,   dd V = sum_f n (sum_k m_k L_k - n w),   winding = sum_f w / 4 pi.
//
// Lengths here are the mesh's over `unit`, a power of two near the body's size, so that numbers of a single-precision range
// hold them; V is then in unit^2, its gradient in unit.
#pragma once

#include "host/polyhedron.hpp"
#include "host/types.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// The largest patch: its corners and edges are counted in 16 bits.
inline constexpr std::size_t largest_polyhedron_patch = 16384;

/// Faces whose height is below this part of their longest edge are left out: they are gaps of that width.
inline constexpr double least_relative_height = 1e-13;

/// The power of two next to half the diagonal of the vertices' box: 1 where that is 0. Throws Error(bad_argument) for
/// coordinates that are not finite or whose box is below 1e-140 or above 1e140.
double polyhedron_unit(std::span<const Vec3> vertices);

/// What is nearer to a face's plane or to an edge, in the mesh's unit, is on it: four units in the last place of the largest
/// coordinate.
double touching_distance(std::span<const Vec3> vertices);

/// [face]: bit k is set where edge k (from corner k to the next) is sharp: the faces that meet there are not coplanar, so
/// that second derivatives are infinite on it.
std::vector<std::uint8_t> sharp_edges(std::span<const Vec3> vertices, std::span<const Face> faces);

/// Which faces make patches, and where these lie.
struct PatchFaces {
  std::span<const std::uint32_t> order;  ///< faces; neighbours in space next to each other
  std::span<const std::uint32_t> starts; ///< [patch]: its first face in `order`; one more at the end
  std::span<const Vec3> centres;         ///< [patch]: origin of its coordinates, in units; empty: (0, 0, 0) for all
  std::span<const std::uint8_t> sharp;   ///< of sharp_edges(); empty where no second derivatives are asked for
};

/// Rows of the sums at points: V, grad V, w/4pi, then dd V (xx, xy, xz, yy, yz, zz), its jump, and on_edge (both are told where
/// they are summed: host/cpu/polyhedron_kernel.hpp).
struct PolyhedronRows {
  static constexpr std::size_t value = 0, gradient = 1, winding = 4, hessian = 5, jump = 11, on_edge = 17;
  /// Rows without second derivatives, and with them.
  static constexpr std::size_t first = 5, second = 18;
};

/// Patches of a closed surface. Normals are right to the rounding of Real, of needles too: of a face whose height is the part
/// q of its longest edge they err by 1e-34/q in double precision.
template <class Real>
class PolyhedronPatches {
public:
  struct Edge {
    Real length;
    std::uint16_t from, to;
    std::uint32_t sharp; ///< 1 where second derivatives are infinite
  };
  struct Face {
    std::array<Real, 3> normal;
    std::array<std::array<Real, 3>, 3> outward; ///< m_k; edge k is from corner k to the next
    Real four_areas;
    Real height; ///< of corner 0 over edge 1
    std::array<std::uint16_t, 3> corners, edges;
  };
  struct Patch {
    std::span<const std::array<Real, 3>> vertices; ///< relative to the centre, each once
    std::span<const Edge> edges;                   ///< each once
    std::span<const Face> faces;
    Vec3 centre; ///< in units
  };

  PolyhedronPatches() = default;
  /// `unit` as of polyhedron_unit(). Throws Error(bad_argument) for patches larger than largest_polyhedron_patch.
  PolyhedronPatches(std::span<const Vec3> vertices, std::span<const cowgpu::Face> faces, const PatchFaces& of,
                    double unit, unsigned threads = 1);
  PolyhedronPatches(PolyhedronPatches&&) = default;
  PolyhedronPatches& operator=(PolyhedronPatches&&) = default;
  PolyhedronPatches(const PolyhedronPatches&) = delete;
  PolyhedronPatches& operator=(const PolyhedronPatches&) = delete;

  std::size_t size() const { return patches_.size(); }
  const Patch& operator[](std::size_t patch) const { return patches_[patch]; }
  std::size_t most_vertices() const { return most_vertices_; } ///< of a patch
  std::size_t most_edges() const { return most_edges_; }       ///< of a patch

  /// Upper bound of the bytes that patches of so many faces take, while they are made too.
  static std::uint64_t bytes(std::uint64_t faces, std::uint64_t patches);

private:
  struct Block { // of patches made by one thread
    std::vector<std::array<Real, 3>> vertices;
    std::vector<Edge> edges;
    std::vector<Face> faces;
  };
  std::vector<Block> blocks_;
  std::vector<Patch> patches_;
  std::size_t most_vertices_ = 0, most_edges_ = 0;
};

extern template class PolyhedronPatches<double>;
extern template class PolyhedronPatches<float>;

} // namespace cowgpu::plan
