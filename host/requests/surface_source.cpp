#include "host/requests/surface_source.hpp"

#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/io/surface_file.hpp"
#include "host/mesh/topology.hpp"
#include "host/mesh/winding_notes.hpp"
#include "host/requests/expand_surfaces.hpp"
#include "host/requests/limits.hpp"
#include "host/requests/memory.hpp"
#include "host/spectrum/expand_surface.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

Body body_of(const std::string& name, const Placement& placement = {}) {
  RawMesh mesh = load_mesh(name);
  place(mesh, placement);
  Body body = make_body(ClosedSurface::from(std::move(mesh)), {}, 1);
  body.placement = placement;
  return body;
}

ExpansionChoice expansion_choice(const SurfaceChoice& choice, int largest_order) {
  const auto map = choice.of.empty() ? MapMethod::stretch : map_method_named(choice.of);
  if (!map)
    throw Error(Fault::bad_argument,
                fmt::format("--of {}: a body is rebuilt over one map: harmonic, stretch, smooth or flow", choice.of));
  ExpansionChoice maps;
  maps.maps = {*map};
  maps.lmax = choice.lmax >= 0 ? choice.lmax : std::max(largest_order, default_lmax);
  return maps;
}

SurfaceSource from_file(const SurfaceChoice& choice, Monitor& monitor) {
  SurfaceSource source{read_surface(choice.input, choice.of)};
  if (choice.mesh.empty()) return source;
  source.body = body_of(choice.mesh, source.placement);
  const RawMesh& mesh = source.body->surface.mesh();
  source.notes = body_notes(source.body->surface, monitor);
  if (mesh.sha256 != source.mesh_hash)
    source.notes.push_back(fmt::format("{} has another SHA-256 than the mesh that was expanded", called(mesh)));
  return source;
}

SurfaceSource from_mesh(const SurfaceChoice& choice, int largest_order, Backend& backend, Monitor& monitor) {
  const ExpansionChoice maps = expansion_choice(choice, largest_order);
  SurfaceSource source;
  source.body = body_of(choice.input);
  const RawMesh& mesh = source.body->surface.mesh();
  source.mesh = mesh.name;
  source.mesh_hash = mesh.sha256;
  source.notes = body_notes(source.body->surface, monitor);
  check_memory(surfaces_memory(maps, mesh.vertices, mesh.faces, backend), backend, "lower --lmax");
  std::vector<SurfaceResult> results = expand_surfaces(maps, false, *source.body, backend, monitor);
  check_surfaces(results);
  SurfaceResult& result = results.front();
  source.name = name(result.of);
  source.expansion = std::move(result.expansion);
  source.recipe = result.recipe;
  source.map_method = name(result.map.method);
  for (const std::string& sentence : result.quality.sentences) source.notes.push_back("map: " + sentence);
  return source;
}

} // namespace

void check_surface_choice(const SurfaceChoice& choice, int largest_order) {
  require_range("the degree is", std::max(choice.lmax, 0), 0, largest_surface_degree);
  if (is_result_file(choice.input)) {
    if (choice.lmax >= 0)
      throw Error(Fault::bad_argument,
                  fmt::format("--lmax is for meshes: {} holds an expansion already", choice.input));
    return;
  }
  if (!choice.mesh.empty())
    throw Error(Fault::bad_argument,
                fmt::format("--mesh is for result files (FILE.json): {} is a mesh already", choice.input));
  const int lmax = expansion_choice(choice, largest_order).lmax;
  if (largest_order > lmax)
    throw Error(Fault::bad_argument, fmt::format("order {} is beyond --lmax {}; raise --lmax", largest_order, lmax));
}

SurfaceSource load_surface(const SurfaceChoice& choice, int largest_order, Backend& backend, Monitor& monitor) {
  check_surface_choice(choice, largest_order);
  const bool file = is_result_file(choice.input);
  SurfaceSource source = file ? from_file(choice, monitor) : from_mesh(choice, largest_order, backend, monitor);
  const int lmax = source.expansion.coefficients.lmax;
  if (largest_order > lmax)
    throw Error(Fault::bad_argument, fmt::format("order {} cannot be rebuilt: {} holds degrees 0 to {}; expand to a "
                                                 "higher lmax",
                                                 largest_order, choice.input, lmax));
  return source;
}

// Eight points a wavelength where that is affordable, two and more always.
int default_resolution(int order) {
  return std::clamp(4 * order, 64, std::max(order, 256));
}

MemoryNeed rebuild_memory(int order, int resolution, const Backend& backend) {
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, resolution);
  MemoryNeed need = backend.sphere_transform(grid, order)->memory(3);
  // Values, vertices, normals and two faces a point; for the measures nine fields on a grid of degree 5/2 order.
  const std::uint64_t fine = std::uint64_t(5 * order / 2 + 2);
  need.host += grid.points() * 128 + 2 * fine * fine * 9 * 8;
  return need;
}

} // namespace cowgpu
