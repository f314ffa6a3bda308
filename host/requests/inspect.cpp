#include "host/requests/inspect.hpp"

#include "host/error.hpp"
#include "host/mesh/half_edges.hpp"
#include "host/mesh/topology.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

constexpr double largest_coordinate = 1e100; // whose differences and their products of three do not overflow

void judge(Inspection& found) {
  try {
    ClosedSurface closed = ClosedSurface::from(found.mesh);
    try {
      require_sphere(ManifoldSurface::from(std::move(closed)));
    } catch (const Error& error) {
      found.maps = fmt::format("no [{}]: {}", name(error.fault()), error.what());
    }
  } catch (const Error& error) {
    found.moments = found.maps = fmt::format("no [{}]: {}", name(error.fault()), error.what());
  }
}

} // namespace

Inspection inspect(RawMesh mesh, Monitor& monitor, unsigned threads) {
  Inspection found;
  found.mesh = std::move(mesh);
  check_stop(monitor);
  found.audit = audit(found.mesh);
  check_stop(monitor);
  judge(found);
  check_stop(monitor);
  const Audit& a = found.audit;
  const std::vector<Vec3>& vertices = found.mesh.vertices;
  const std::vector<Face>& faces = found.mesh.faces;
  const double largest = std::max(a.box.min.cwiseAbs().maxCoeff(), a.box.max.cwiseAbs().maxCoeff());
  if (!a.finite || faces.empty() || largest > largest_coordinate) return found;
  const Bvh tree(vertices, faces);
  found.intersections = self_intersections(vertices, faces, tree, monitor, threads);
  if (!a.volume) return found;
  if (!found.intersections->complete) return found;
  found.overlap = overlap(vertices, faces, tree, *found.intersections, monitor, threads);
  const TriangleSheet sheet = body_boundary(vertices, faces, tree, *found.intersections, monitor, threads);
  const Bvh boundary(sheet.vertices, sheet.faces);
  if (const LargestBall ball = largest_ball(vertices, faces, tree, boundary, monitor); ball.radius > 0)
    found.largest_ball = ball;
  if (!a.centre_of_mass) return found;
  found.brillouin_radius = brillouin_radius(vertices, faces, *a.centre_of_mass);
  found.inscribed_radius = inscribed_radius(vertices, faces, tree, boundary, *a.centre_of_mass);
  return found;
}

} // namespace cowgpu
