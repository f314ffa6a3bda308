#include "host/requests/places.hpp"

#include "host/error.hpp"
#include "host/requests/limits.hpp"
#include "host/sphere_directions.hpp"

#include <fmt/format.h>

namespace cowgpu {
namespace {

double length_of(const char* option, const Reach& reach, const PlaceFrame& frame) {
  if (reach.radii) return reach.length.value * frame.radius;
  if (reach.length.has_unit && !frame.metric)
    throw Error(
        Fault::bad_argument,
        fmt::format("{} {} m: a length with a unit needs the mesh's: add --length-unit or --length; a bare number "
                    "is in the mesh's unit, and 1.5R is one and a half times its sphere",
                    option, reach.length.value));
  return reach.length.value;
}

Places plane(const PlaneRequest& request, const PlaceFrame& frame) {
  const double offset = length_of("--plane", request.offset, frame),
               extent = length_of("--plane", request.extent, frame);
  if (!(extent > 0))
    throw Error(Fault::bad_argument, fmt::format("--plane: a plane of the extent {} has no points", extent));
  Places places;
  const int u = (request.axis + 1) % 3, v = (request.axis + 2) % 3;
  const double step = 2 * extent / (request.count - 1);
  for (int j = 0; j < request.count; ++j)
    for (int i = 0; i < request.count; ++i) {
      Vec3 p = frame.origin;
      p[request.axis] += offset;
      p[u] += i * step - extent;
      p[v] += j * step - extent;
      places.points.push_back(p);
    }
  places.name = fmt::format("plane across {} at {:.6g} from the origin, {} x {} points up to {:.6g} from its middle",
                            "xyz"[request.axis], offset, request.count, request.count, extent);
  return places;
}

Places lattice(const GridRequest& request, const PlaceFrame& frame) {
  const double extent = length_of("--grid", request.extent, frame);
  if (!(extent > 0))
    throw Error(Fault::bad_argument, fmt::format("--grid: a cube of the extent {} has no points", extent));
  Places places;
  const int n = request.count;
  const double step = 2 * extent / (n - 1);
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        places.points.emplace_back(frame.origin + step * Vec3(i, j, k) - Vec3::Constant(extent));
  places.lattice = {n, n, n};
  places.name =
      fmt::format("lattice of {} x {} x {} points up to {:.6g} from the origin along each axis", n, n, n, extent);
  return places;
}

Places sphere(const SphereRequest& request, const PlaceFrame& frame) {
  Places places;
  places.radius = length_of("--sphere", request.radius, frame);
  if (!(places.radius > 0))
    throw Error(Fault::bad_argument, fmt::format("--sphere {}: the radius must be above 0", places.radius));
  places.grid = make_grid(GridKind::gauss_legendre, request.rings - 1);
  const SphereDirections to(*places.grid);
  for (int i = 0; i < places.grid->rings; ++i)
    for (int j = 0; j < places.grid->ring_length; ++j)
      places.points.emplace_back(frame.origin + places.radius * to(i, j));
  places.name = fmt::format("sphere of radius {:.6g} about the origin, {} rings of {} points", places.radius,
                            places.grid->rings, places.grid->ring_length);
  return places;
}

void check_counts(const PlaceRequest& request) {
  if (const auto* sphere = std::get_if<SphereRequest>(&request);
      sphere && (sphere->rings < 1 || sphere->rings > largest_grid_degree + 1))
    throw Error(Fault::bad_argument,
                fmt::format("a sphere of {} rings: there are from 1 to {}", sphere->rings, largest_grid_degree + 1));
  if (const auto* grid = std::get_if<GridRequest>(&request);
      grid && (grid->count < 2 || grid->count > most_along_grid))
    throw Error(Fault::bad_argument,
                fmt::format("a lattice of {} points a side: there are from 2 to {}", grid->count, most_along_grid));
  const auto* plane = std::get_if<PlaneRequest>(&request);
  if (plane && (plane->axis < 0 || plane->axis > 2 || plane->count < 2 || plane->count > most_along_plane))
    throw Error(Fault::bad_argument,
                fmt::format("a plane across axis {} with {} points a side: axes are 0, 1 and 2, and "
                            "sides have from 2 to {} points",
                            plane->axis, plane->count, most_along_plane));
}

} // namespace

std::size_t count_places(const PlaceRequest& request) {
  check_counts(request);
  if (const auto* points = std::get_if<PointsRequest>(&request)) return points->points.size();
  if (const auto* sphere = std::get_if<SphereRequest>(&request))
    return std::size_t(sphere->rings) * std::size_t(2 * sphere->rings + 16);
  if (const auto* grid = std::get_if<GridRequest>(&request)) {
    const auto n = std::size_t(grid->count);
    return n * n * n;
  }
  const auto n = std::size_t(std::get<PlaneRequest>(request).count);
  return n * n;
}

Places find_places(const PlaceRequest& request, const PlaceFrame& frame) {
  check_counts(request);
  if (const auto* points = std::get_if<PointsRequest>(&request)) return {points->name, points->points, {}, 0, {}};
  if (const auto* wanted = std::get_if<SphereRequest>(&request)) return sphere(*wanted, frame);
  if (const auto* wanted = std::get_if<GridRequest>(&request)) return lattice(*wanted, frame);
  return plane(std::get<PlaneRequest>(request), frame);
}

} // namespace cowgpu
