#include "host/requests/streamlines.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/topology.hpp"
#include "host/mesh/winding_notes.hpp"
#include "host/requests/expand_flow.hpp"
#include "host/requests/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

StreamlineStarts starts_of(const StreamlinesRequest& request, const RawMesh& mesh, const StreamlineTable& table) {
  if (request.within) {
    StreamlineStarts starts = starts_near(table.plane, *request.within, mesh.vertices, mesh.faces);
    if (starts.places.empty())
      throw Error(Fault::mesh_empty,
                  fmt::format("no vertex of {} lies within {} of the plane: start at vertices farther from it, or on "
                              "the cut",
                              called(mesh), *request.within));
    return starts;
  }
  double length = 0;
  for (const CutLoop& loop : table.cut) length += loop.length;
  const double count = request.space ? std::max(1.0, std::round(length / *request.space)) : double(request.count);
  if (count > double(most_streamlines))
    throw Error(Fault::bad_argument,
                fmt::format("starts {} apart make {:.3g} lines along a cut of length {:.6g}: at most {} are drawn; "
                            "take a larger spacing",
                            *request.space, count, length, most_streamlines));
  return starts_along(table.cut, std::size_t(count), mesh.vertices, mesh.faces);
}

void check(const StreamlinesRequest& request) {
  require_range("the lines are", request.count, std::size_t(1), most_streamlines);
  if (request.time) require_positive("the time is", *request.time);
  if (request.space) require_positive("the spacing is", *request.space);
  if (request.within) require_not_negative("the distance of vertices from the plane is", *request.within);
  require_range("the tolerance is", request.tolerance, least_tolerance, largest_tolerance);
}

} // namespace

StreamlinesResult find_streamlines(StreamlinesRequest request, Backend& backend, Monitor& monitor) {
  check(request);
  auto start = Clock::now();
  StreamlinesResult result;
  result.device = backend.facts();
  const ClosedSurface surface = ClosedSurface::from(std::move(request.mesh));
  result.notes = body_notes(surface, monitor, request.threads);
  const RawMesh& mesh = result.mesh = surface.mesh();
  StreamlineTable& table = result.table;
  table.mesh = mesh.name;
  table.sha256 = mesh.sha256;
  table.plane = request.plane;
  table.origin = request.origin;
  const Box box = bounding_box(surface);
  if (request.time) check_flow_time(*request.time, box);
  table.time = request.time.value_or((box.max - box.min).norm());
  table.tolerance = request.tolerance;
  table.cut = cut_by_plane(mesh.vertices, mesh.faces, table.plane);
  if (table.cut.empty() && !request.within) {
    const Plane& p = table.plane;
    throw Error(Fault::mesh_empty,
                fmt::format("the plane {:.6g} x + {:.6g} y + {:.6g} z = {:.6g} misses {}, whose box goes from ({:.6g}, "
                            "{:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}): choose another plane",
                            p.normal.x(), p.normal.y(), p.normal.z(), p.offset, called(mesh), box.min.x(), box.min.y(),
                            box.min.z(), box.max.x(), box.max.y(), box.max.z()));
  }
  table.starts = starts_of(request, mesh, table);
  result.read_seconds = seconds_since(start);
  start = Clock::now();
  const auto flow = backend.distance_flow(mesh.vertices, mesh.faces);
  FlowOptions how;
  how.time = table.time;
  how.tolerance = table.tolerance;
  table.found = streamlines(mesh.vertices, mesh.faces, table.starts, table.origin, how, *flow, backend, monitor);
  result.flow_seconds = seconds_since(start);
  return result;
}

} // namespace cowgpu
