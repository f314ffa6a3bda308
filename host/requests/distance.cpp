#include "host/requests/distance.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/winding_notes.hpp"
#include "host/requests/limits.hpp"
#include "host/requests/memory.hpp"

#include <fmt/format.h>

namespace cowgpu {

DistancePlan::DistancePlan(DistanceRequest request, Monitor& monitor) {
  if (request.lattice)
    require_range("the points along a side of the lattice are", *request.lattice, least_lattice, most_lattice);
  const auto start = Clock::now();
  result.with_sign = request.with_sign;
  if (request.with_sign) {
    const ClosedSurface surface = ClosedSurface::from(std::move(request.mesh));
    result.notes = body_notes(surface, monitor, request.threads);
    result.mesh = surface.mesh();
  } else {
    check_distance_surface(request.mesh.vertices, request.mesh.faces);
    result.mesh = std::move(request.mesh);
    result.notes = result.mesh.notes;
  }
  if (request.lattice) {
    const Box box = bounding_box(result.mesh.vertices, result.mesh.faces);
    result.lattice = lattice_about(box.min, box.max, lattice_enlargement, *request.lattice);
    count = result.lattice->size();
  } else {
    result.queries = std::move(request.points);
    count = result.queries.size();
  }
  result.read_seconds = seconds_since(start);
}

MemoryNeed DistancePlan::memory(const Backend& backend) const {
  MemoryNeed need = backend.distance_field(result.mesh.vertices, result.mesh.faces)->memory(count);
  need.host += 24 * count + 152 * count; // queries and result; a file's image, netCDF or text
  return need;
}

void check_distance_memory(const DistancePlan& plan, const Backend& backend) {
  check_memory(plan.memory(backend), backend, plan.result.lattice ? "lower --grid" : "pass fewer points at once");
}

DistanceResult find_distances(DistancePlan plan, Backend& backend, Monitor& monitor) {
  const auto start = Clock::now();
  DistanceResult& result = plan.result;
  check_distance_memory(plan, backend);
  result.device = backend.facts();
  if (result.lattice) result.queries = result.lattice->points();
  const auto field = backend.distance_field(result.mesh.vertices, result.mesh.faces);
  field->prepare();
  result.setup_seconds = seconds_since(start);
  result.points = field->closest(result.queries, {result.with_sign}, monitor, &result.report);
  return std::move(result);
}

} // namespace cowgpu
