#include "host/requests/render.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/io/surface_file.hpp"
#include "host/mesh/topology.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/mesh/winding_notes.hpp"
#include "host/requests/limits.hpp"
#include "host/requests/memory.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

// Notes of a closed surface; of one that is not, those of its reading: it is shown as it is.
std::vector<std::string> notes_on(const RawMesh& mesh, Monitor& monitor, unsigned threads) {
  try {
    return body_notes(ClosedSurface::from(mesh), monitor, threads);
  } catch (const Error& error) {
    if (error.fault() == Fault::interrupted) throw;
    return mesh.notes;
  }
}

TriangleSurface shown_mesh(const RawMesh& mesh) {
  require_valid_indices(mesh);
  TriangleSurface surface;
  surface.vertices = mesh.vertices;
  surface.faces = mesh.faces;
  return surface;
}

int largest_order(const RenderRequest& request) {
  int largest = 0;
  for (const auto& order : request.orders) largest = std::max(largest, order.value_or(0));
  return largest;
}

TriangleSurface rebuilt(const RenderRequest& request, const SurfaceSource& source, int order, Backend& backend,
                        Monitor& monitor) {
  const int resolution = request.resolution > 0 ? request.resolution : default_resolution(order);
  check_memory(rebuild_memory(order, resolution, backend), backend, "lower --order or --resolution");
  return reconstruct(source.expansion, request.fields, order, make_grid(GridKind::clenshaw_curtis, resolution), backend,
                     monitor);
}

// The bodies to show, one after the other.
std::vector<TriangleSurface> bodies(const RenderRequest& request, Backend& backend, Monitor& monitor,
                                    std::vector<std::string>& notes) {
  if (!request.rebuilds()) {
    const RawMesh mesh = load_mesh(request.source.input);
    notes = notes_on(mesh, monitor, request.threads);
    return {shown_mesh(mesh)};
  }
  const SurfaceSource source = load_surface(request.source, largest_order(request), backend, monitor);
  notes = source.notes;
  if (request.orders.empty()) return {rebuilt(request, source, source.expansion.coefficients.lmax, backend, monitor)};
  std::vector<TriangleSurface> found;
  for (const auto& order : request.orders) {
    if (!order && !source.body)
      throw Error(Fault::bad_argument, fmt::format("--order mesh: {} does not hold the mesh; name it with --mesh MESH",
                                                   request.source.input));
    found.push_back(order ? rebuilt(request, source, *order, backend, monitor)
                          : shown_mesh(source.body->surface.mesh()));
  }
  return found;
}

} // namespace

Image draw_picture(const PictureRequest& request, Backend& backend, Monitor& monitor) {
  return backend.render(figures::scene_of(request.bodies, request.views, request.panels), monitor);
}

void check_render(const RenderRequest& request) {
  require_member("the fields are", request.fields, SurfaceFields::f);
  require_range("the resolution is", request.resolution, 0, largest_grid_degree);
  const int largest = largest_order(request);
  if (request.rebuilds()) check_surface_choice(request.source, largest);
  if (request.resolution > 0 && request.resolution < largest)
    throw Error(Fault::bad_argument, fmt::format("--resolution {} cannot show order {}; it must be at least the order",
                                                 request.resolution, largest));
}

RenderResult render(const RenderRequest& request, Backend& backend, Monitor& monitor) {
  check_render(request);
  RenderResult result;
  PictureRequest picture{bodies(request, backend, monitor, result.notes), request.views, request.panels};
  for (TriangleSurface& body : picture.bodies) {
    result.triangles += body.faces.size();
    if (request.flat)
      body.normals.clear();
    else if (body.normals.empty())
      body.normals = vertex_normals(body.vertices, body.faces);
  }
  const auto start = Clock::now();
  result.image = draw_picture(picture, backend, monitor);
  result.seconds = seconds_since(start);
  return result;
}

} // namespace cowgpu
