// The stage `polyhedron` on a device: the faces of patches in strips, and which patches are near to which groups of points.
#pragma once

#include "host/plan/polyhedron.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu::plan {

/// Where the distance of points from a patch's box is above this many of its longest edges, its closed forms are short series:
/// there a + b > 5.1 e at each edge, and |tan(w/2)| < 0.04 at each face.
inline constexpr double far_edges = 2.6;

/// Faces one after the other, each but a strip's first on an edge of the one before: a step for each face, and two more where
/// a strip begins.
struct PolyhedronStrips {
  /// Numbers of a step: the new corner N (3); of the face P Q N its normal (3), the normals in its plane of PQ, QN and NP (9),
  /// four times its area, the height of N over PQ; the lengths of QN and NP; the bits of a whole number of flags.
  static constexpr std::size_t numbers = 20;
  static constexpr std::uint64_t keep_p = 1, sharp_pq = 2, sharp_qn = 4, sharp_np = 8, first = 16; ///< flags

  std::vector<double> steps;
  std::vector<std::uint32_t> starts; ///< [patch]: its first step; one more at the end
  struct Box {
    Vec3 low, high;
    double longest; ///< edge
  };
  std::vector<Box> boxes; ///< [patch]

  std::size_t faces = 0;
  static std::uint64_t bytes(std::uint64_t faces) { return faces * (3 * numbers * 8 + 1) + faces * 16; }
};

/// Of patches whose centres are the origin. Throws Error(too_large) for more than 2^32 steps.
PolyhedronStrips polyhedron_strips(const PolyhedronPatches<double>& patches);

/// Ranges of steps for groups of points: of group g the pairs (first step, the step behind the last) from starts[g] on.
struct StepLists {
  std::vector<std::array<std::uint32_t, 2>> ranges;
  std::vector<std::uint32_t> starts = {0};

  /// Adds a range to the group that is not ended yet; joins it to the one before where they touch.
  void add(std::uint32_t first, std::uint32_t end);
  void end_group() { starts.push_back(std::uint32_t(ranges.size())); }
};

/// The box of points, of at least one.
struct PointBox {
  explicit PointBox(std::span<const Vec3> points);
  Vec3 low, high;
};

/// Patches for groups of points: the near ones and the far ones.
struct DirectLists {
  StepLists near, far;

  /// Adds a patch to the group that is not ended yet, whose points lie in the box, in units.
  void add(const PolyhedronStrips& strips, std::size_t patch, const PointBox& points);
  void end_group();
};
/// All patches for groups of `size` points next to each other (the last may be smaller), in units.
DirectLists direct_lists(const PolyhedronStrips& strips, std::span<const Vec3> points, std::size_t size);

} // namespace cowgpu::plan
