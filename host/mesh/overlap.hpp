// The volume that a closed surface encloses more than once, or the wrong way round.
#pragma once

#include "host/geometry/bvh.hpp"
#include "host/mesh/self_intersections.hpp"
#include "host/monitor.hpp"

#include <span>
#include <vector>

namespace cowgpu {

/// A volume and how far it may be off.
struct RegionVolume {
  double volume = 0;
  double uncertainty = 0;
};

/// Where the winding number is neither 0 nor 1.
struct Overlap {
  RegionVolume overlapped; ///< winding number 2 or more
  RegionVolume inverted;   ///< winding number below 0: inside out
};

/// Both volumes by the divergence theorem over their boundaries, which are pieces of the surface: faces that meet others
/// are cut along the segments they meet in, and each piece belongs to a boundary or not by the winding numbers on its two
/// sides; patches of other faces need one look together. Where sheets lie on each other exactly the flow through all of
/// them is shared out among them.
///
/// So nothing is sampled: what is off is rounding, and pieces whose side it gets wrong. These leave a boundary open, so the
/// uncertainty is estimated by the vector area of what was found as a boundary, which is 0 of a closed one, times the
/// diagonal of its box, plus 1e-13 of the volume of that box. Where that is above 1 % of the volume, as of sheets that lie
/// within a rounding of each other but not on each other, winding numbers at `most_points` points of the whole box take over if
/// they know better, with twice their standard error.
///
/// Of a closed surface whose edges are run as often one way as the other; for others the result means nothing. `tree` is
/// that of the faces, `pairs` all their intersections. The same on any number of threads. Throws Error(interrupted).
Overlap overlap(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree,
                const SelfIntersections& pairs, Monitor& monitor, unsigned threads = 0,
                std::size_t most_points = std::size_t(1) << 19);

/// Triangles that lie on another surface and cover parts of it.
struct TriangleSheet {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
};

/// What bounds the body, where the winding number is above 0: pieces of the surface with it on one side only. Faces that
/// nothing cuts are whole, others cut as for overlap(), with corners rounded. Parts inside the body, as of shells that pass
/// through each other, and outside of it, as of shells that look inwards, are left out. Expects and throws what overlap()
/// does.
TriangleSheet body_boundary(std::span<const Vec3> vertices, std::span<const Face> faces, const Bvh& tree,
                            const SelfIntersections& pairs, Monitor& monitor, unsigned threads = 0);

} // namespace cowgpu
