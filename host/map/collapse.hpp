// Simplification of a triangulated sphere down to a tetrahedron, vertex by vertex, and back.
//
// A half-edge collapse v -> u removes v and joins its ring to u (H. Hoppe, Progressive meshes, SIGGRAPH 1996). It keeps a
// triangulated sphere one if v and u have exactly two common neighbours (link condition). Any vertex of a triangulated
// sphere with more than four vertices has such a neighbour: the chords of its ring do not cross, so some corner of the
// ring has none. The way down therefore never ends early, whatever is preferred on it.
#pragma once

#include "host/types.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu {

/// One step of the way down.
struct Collapse {
  std::uint32_t vertex;            ///< removed
  std::vector<std::uint32_t> ring; ///< its neighbours, counter-clockwise seen from outside; the first is where it went
};

/// The neighbours of each vertex in cyclic order, of a triangulated sphere that is taken apart and put together.
class VertexRings {
public:
  /// Of each vertex counter-clockwise seen from outside.
  explicit VertexRings(std::vector<std::vector<std::uint32_t>> rings) : rings_(std::move(rings)) {}

  /// Empty for a removed vertex. Where it starts is not defined.
  std::span<const std::uint32_t> of(std::uint32_t vertex) const { return rings_[vertex]; }
  std::size_t size() const { return rings_.size(); }
  bool link_condition(std::uint32_t v, std::uint32_t u) const;
  /// Removes v, whose link condition with its neighbour u holds.
  Collapse collapse(std::uint32_t v, std::uint32_t u);
  /// Puts the vertex of the last collapse not yet undone back; `collapse` loses its ring.
  void undo(Collapse&& collapse);

private:
  bool adjacent(std::uint32_t a, std::uint32_t b) const;
  std::vector<std::vector<std::uint32_t>> rings_;
};

/// Collapses down to four vertices and returns the steps in order. The cheapest first: the quadric error of v at u (M.
/// Garland, P. Heckbert, SIGGRAPH 1997), with penalties on long edges, on misshapen triangles round u, and on valences.
/// `points` in any scale with edges far from the ends of the range of doubles. Costs are compared in single precision,
/// and equal ones taken in the order of the vertices, so that rounding in the input hardly ever changes the way.
std::vector<Collapse> collapse_to_tetrahedron(VertexRings& rings, std::span<const Vec3> points);

} // namespace cowgpu
