// A surface in an order of its own, so that maps depend on its shape and not on how its vertices are numbered.
#pragma once

#include "host/mesh/closed_surface.hpp"

#include <cstdint>
#include <vector>

namespace cowgpu {

/// The vertices that belong to a face, renumbered, shifted and scaled.
struct CanonicalSurface {
  std::vector<std::uint32_t> original; ///< vertex k here is vertex original[k] of the mesh
  std::vector<Vec3> points;            ///< total area 4 pi, the area's centroid at the origin
  /// Neighbours of each vertex, counter-clockwise seen from outside, starting at the smallest number.
  std::vector<std::vector<std::uint32_t>> rings;
};

/// The order is by coordinates along the principal axes of the area, directed by its skewness and rounded to 2^-24 of
/// the body's size: the same for a mesh renumbered, and for one moved, turned or scaled but for what symmetry or rounding
/// leaves open. A renumbered mesh gives the same bits (unless coincident vertices also have coincident neighbours).
/// `surface` is one component of genus 0. Throws Error(Fault::mesh_no_volume) if the area is zero in double precision.
CanonicalSurface canonical_surface(const ManifoldSurface& surface);

/// Calls f(a, b, c) for every face, counter-clockwise seen from outside, a being the smallest number: in the order of a,
/// then along its ring.
template <class Function>
void for_each_face(const std::vector<std::vector<std::uint32_t>>& rings, Function&& f) {
  for (std::uint32_t a = 0; a < rings.size(); ++a)
    for (std::size_t i = 0, n = rings[a].size(); i < n; ++i) {
      const std::uint32_t b = rings[a][i], c = rings[a][i + 1 == n ? 0 : i + 1];
      if (a < b && a < c) f(a, b, c);
    }
}

} // namespace cowgpu
