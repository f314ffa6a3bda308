// How two triangles of a mesh meet, by exact signs.
#pragma once

#include "host/types.hpp"

#include <cstdint>
#include <span>
#include <string_view>

namespace cowgpu {

/// What two triangles have in common beyond the vertices and the edge that they share by their numbers.
enum class Meeting : std::uint8_t {
  none,
  touching,    ///< points only, or a segment where one of them does not pass through the plane of the other
  crossing,    ///< a segment along which each passes through the other
  overlapping, ///< an area: they lie in one plane
};

/// "none", "touching", "crossing", "overlapping".
std::string_view name(Meeting meeting);

struct TrianglePair {
  Meeting meeting = Meeting::none;
  /// Triangles of different planes have a segment in common: from - to, rounded; else from = to.
  bool segment = false;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero(); ///< the ends of the cut; for an overlap a point near it
};

/// How faces f and g meet. Both must have area and finite corners, whose differences do not overflow; rounding decides
/// nothing but where `from` and `to` are. Vertices of different numbers are different even at one point: triangles meet
/// there. Intervals on the common line are compared by signs of orientation as in P. Guigue and O. Devillers, Journal of
/// Graphics Tools 8 (2003) 25, edges and corners included; triangles of one plane by the lines that separate them.
TrianglePair meet(std::span<const Vec3> vertices, const Face& f, const Face& g);

/// The axis along which a triangle is seen with an area (0 x, 1 y, 2 z), or -1 if it has none: all corners on a line. Exact.
int axis_with_area(const Vec3& a, const Vec3& b, const Vec3& c);

} // namespace cowgpu
