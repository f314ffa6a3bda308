// Streamlines of the distance's flow off the cut of a surface with a plane: what a figure of the flow shows.
#pragma once

#include "host/backend.hpp"
#include "host/flow.hpp"

#include <span>
#include <string>
#include <vector>

namespace cowgpu {

/// The points x with normal . x = offset. The normal may have any length above 0.
struct Plane {
  Vec3 normal = Vec3::UnitX();
  double offset = 0;

  /// Unit axes for pictures, u x v along the normal: v is z as seen in the plane, or y where the plane is across z.
  Vec3 u() const;
  Vec3 v() const;
  double height(const Vec3& x) const { return (normal.dot(x) - offset) / normal.norm(); }
  /// 1 above (where the normal points), -1 below, 0 on the plane: exact unless a product leaves the range of doubles.
  int side(const Vec3& x) const;
};

/// "yz", "xy" and "xz" (through the mesh's origin; u and v are the letters in their order), or "NX,NY,NZ,D". Throws
/// Error(bad_argument) for other words, and for a normal that is zero or not finite.
Plane parse_plane(const std::string& text);

/// A closed polyline in the plane. Segment i, from point i to the next, lies in faces[i].
struct CutLoop {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> faces;
  double length = 0;
};

/// Where the plane meets a closed surface. Loops run about the body counter-clockwise seen against the normal, round its
/// cavities clockwise. A vertex on the plane is a point of the loop itself, and is held to be above (of a surface that is nowhere
/// below the plane: below), so that a face in the plane counts as above, too, and gives its outline if what it bounds is
/// below. Loops of length 0 are left out. Throws Error(mesh_open) for a surface that is not closed.
std::vector<CutLoop> cut_by_plane(std::span<const Vec3> vertices, std::span<const Face> faces, const Plane& plane);

/// Where streamlines start, and the way they leave.
struct StreamlineStarts {
  std::vector<Vec3> places, normals;
  std::vector<std::uint32_t> loops; ///< loop of the cut that each place lies on; empty for vertices
};

/// `count` starts along the loops, as evenly as whole numbers on each allow, the first half a spacing from a loop's first
/// point; they leave along their face's normal.
StreamlineStarts starts_along(std::span<const CutLoop> loops, std::size_t count, std::span<const Vec3> vertices,
                              std::span<const Face> faces);

/// The mesh's vertices no farther than `within` from the plane, in their order; they leave along the angle-weighted normal.
StreamlineStarts starts_near(const Plane& plane, double within, std::span<const Vec3> vertices,
                             std::span<const Face> faces);

/// Streamlines in space; a figure projects them on the plane's axes.
struct Streamlines {
  FlowPoints lines;              ///< paths kept: corners, where the line turns or a step of a slide ends
  std::vector<double> distances; ///< at each corner, negative inside
  std::vector<Vec3> directions; ///< unit vectors from the origin to the ends, on the sphere; 0 for an end at the origin
  FlowReport report;
};

/// Flows the starts by events. `options.streamlines` is taken as true. Throws what DistanceFlow and
/// DistanceField throw.
Streamlines streamlines(std::span<const Vec3> vertices, std::span<const Face> faces, const StreamlineStarts& starts,
                        const Vec3& origin, FlowOptions options, DistanceFlow& flow, Backend& backend,
                        Monitor& monitor);

} // namespace cowgpu
