// Streamlines in files. The layouts are fixed: later versions may add columns and members.
//
// CSV: lines "# key value" (cowgpu, mesh, sha256, normal, offset, axis_u, axis_v, origin, time), then the names
//   line,time,x,y,z,u,v,height,distance,direction_u,direction_v,flags
// and one row a corner, line after line. u, v are the coordinates along the plane's axes of the corner's projection, height is
// how far it is above the plane; distance is from the surface, negative inside; direction_u, direction_v are u and v of the unit
// vector from the origin to the corner: on a line's last row its point on the circle (on it only if it ends in the plane through
// the origin, else within); flags are the line's (bits of FlowFlag).
// JSON: data/schemas/cowgpu.streamlines.v1.json.
#pragma once

#include "host/document.hpp"
#include "host/flow/streamlines.hpp"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// What a file of streamlines holds.
struct StreamlineTable {
  std::string mesh, sha256;
  Plane plane;
  Vec3 origin = Vec3::Zero();
  double time = 0, tolerance = 0;
  std::vector<CutLoop> cut;
  StreamlineStarts starts;
  Streamlines found;
};

void write_streamlines_csv(const StreamlineTable& table, const Sink& sink);

/// The members mesh, plane, origin, time, tolerance, cut, counts, lines of the document.
Object members(const StreamlineTable& table);

} // namespace cowgpu
