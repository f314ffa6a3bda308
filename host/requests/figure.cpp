#include "host/requests/figure.hpp"

#include "host/error.hpp"
#include "host/io/mesh_values_read.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/mesh/topology.hpp"
#include "host/physics/tip.hpp"
#include "host/requests/limits.hpp"
#include "host/requests/surface_gravity.hpp"
#include "host/requests/surface_source.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>

namespace cowgpu {
namespace {

// A mesh's name without its folder.
std::string short_name(const RawMesh& mesh) {
  return std::filesystem::path(mesh.name).filename();
}

std::string map_title(std::string_view map) {
  return map == name(MapMethod::flow) ? "gradient flow" : fmt::format("{} map", map);
}

// A request with what its figure is drawn on.
struct Drawing {
  const FigureRequest& request;
  const Body& body;
  Backend& backend;
  Monitor& monitor;

  const RawMesh& mesh() const { return body.surface.mesh(); }
};

plot::Canvas orders(const Drawing& on, const SurfaceExpansion& expansion, std::string_view map) {
  return figures::orders_figure(expansion, SurfaceFields::xyz, on.mesh(), on.request.view,
                                fmt::format("{}, {}", short_name(on.mesh()), map_title(map)), on.backend, on.monitor);
}

Multipoles mass_of(const Drawing& on) {
  return mass_moments(mass_problems(on.body, on.request.expansions.lmax, default_cut_off), on.backend, on.monitor);
}

// Expansions that are in files, with the mass of the mesh beside them.
plot::Canvas of_results(const Drawing& on) {
  std::vector<SurfaceSource> sources;
  for (const std::string& file : on.request.results) {
    SurfaceChoice choice;
    choice.input = file;
    sources.push_back(load_surface(choice, 0, on.backend, on.monitor));
    const std::string& hash = sources.back().mesh_hash;
    if (!hash.empty() && hash != on.mesh().sha256)
      throw Error(Fault::file_format, fmt::format("--result {}: it is of {}, another mesh than {} by its SHA-256; name "
                                                  "that mesh, or expand this one",
                                                  file, sources.back().mesh, called(on.mesh())));
  }
  if (on.request.kind == FigureKind::orders) return orders(on, sources[0].expansion, sources[0].name);
  std::vector<figures::NamedExpansion> named;
  for (const SurfaceSource& source : sources) named.push_back({map_title(source.name), &source.expansion});
  const Multipoles mass = mass_of(on);
  return figures::spectra_figure(on.request.format, named, &mass);
}

std::vector<SurfaceResult> expand(const Drawing& on, const ExpansionChoice& choice) {
  std::vector<SurfaceResult> results = expand_surfaces(choice, false, on.body, on.backend, on.monitor);
  check_surfaces(results);
  return results;
}

// Those that can be made.
std::vector<SurfaceResult> expand_possible(const Drawing& on, std::vector<std::string>& left_out) {
  std::vector<SurfaceResult> results;
  for (const MapMethod map : on.request.expansions.maps) {
    ExpansionChoice one = on.request.expansions;
    one.maps = {map};
    try {
      results.push_back(std::move(expand(on, one).front()));
    } catch (const Error& error) {
      if (error.fault() != Fault::map_failed && error.fault() != Fault::check_failed) throw;
      left_out.push_back(fmt::format("the {} is left out: {}", map_title(name(map)), error.what()));
    }
  }
  return results;
}

plot::Canvas of_expansions(const Drawing& on, std::vector<std::string>& left_out) {
  const FigureRequest& request = on.request;
  const ExpansionChoice& choice = request.expansions;
  const std::vector<SurfaceResult> results = request.leave_out ? expand_possible(on, left_out) : expand(on, choice);
  if (request.kind == FigureKind::spectra) {
    std::vector<figures::NamedExpansion> named;
    for (const SurfaceResult& result : results) named.push_back({map_title(name(result.of)), &result.expansion});
    Multipoles mass;
    if (choice.mass) mass = mass_of(on);
    return figures::spectra_figure(request.format, named, choice.mass ? &mass : nullptr);
  }
  const SurfaceResult& result = results.front();
  if (request.kind == FigureKind::orders) return orders(on, result.expansion, name(result.of));
  if (request.kind == FigureKind::components)
    return figures::components_figure(on.mesh(), result.map, result.expansion.origin, request.view,
                                      fmt::format("{}, {}", short_name(on.mesh()), map_title(name(result.of))),
                                      on.backend, on.monitor);
  return figures::definition_figure(request.format, on.mesh(), result.map, result.expansion.origin);
}

// A ball of the body's volume on the left, the body on the right.
plot::Canvas tipping(const Drawing& on) {
  using namespace physics;
  const RigidBody cow = solid_body(on.body);
  const Stance stance = stand(cow, {}), ball = stand(ball_like(cow, on.body.mass()), {.as_modelled = true});
  const Tipping of_cow = physics::tipping(stance, Side::right), of_ball = physics::tipping(ball, Side::right);
  const std::array shown = {figures::TippedBody{&ball, &of_ball, "spherical body"},
                            figures::TippedBody{&stance, &of_cow, short_name(on.mesh())}};
  return figures::tipping_figure(shown, on.backend, on.monitor);
}

plot::Canvas draw(const Drawing& on, std::vector<std::string>& left_out) {
  const FigureRequest& request = on.request;
  switch (request.kind) {
  case FigureKind::inflation: return figures::inflation_figure(on.mesh(), request.view, on.backend, on.monitor);
  case FigureKind::streamlines:
    return figures::streamlines_figure(request.format, on.mesh(), request.plane, on.body.origin, request.streamlines,
                                       on.backend, on.monitor);
  case FigureKind::tipping: return tipping(on);
  default: return request.results.empty() ? of_expansions(on, left_out) : of_results(on);
  }
}

// Values that are in a file, on the mesh, or those of its faces where it rests.
MeshValues values_of(const FigureRequest& request, Backend& backend, Monitor& monitor) {
  if (!request.values.empty()) {
    MeshValues values = read_mesh_values(request.values);
    put_on(values, request.mesh.vertices, request.mesh.faces);
    return values;
  }
  SurfaceGravityRequest gravity;
  gravity.body.mesh = request.mesh_name;
  gravity.threads = request.threads;
  return surface_gravity(plan_surface_gravity(std::move(gravity), monitor), backend, monitor).values;
}

plot::Canvas of_values(const FigureRequest& request, Backend& backend, Monitor& monitor) {
  const MeshValues values = values_of(request, backend, monitor);
  return figures::surface_values_figure(request.format, values, request.colour, request.views, backend, monitor);
}

bool of_one_map(FigureKind kind) {
  return kind == FigureKind::orders || kind == FigureKind::components || kind == FigureKind::definition;
}

} // namespace

bool can_be_svg(FigureKind kind) {
  return kind == FigureKind::spectra || kind == FigureKind::definition || kind == FigureKind::streamlines ||
         kind == FigureKind::surface;
}

FigureResult make_figure(FigureRequest request, Backend& backend, Monitor& monitor) {
  if (request.kind == FigureKind::surface) return {of_values(request, backend, monitor), {}};
  const ExpansionChoice& choice = request.expansions;
  require_member("the figure is", request.kind, FigureKind::tipping);
  require_member("the format is", request.format, plot::PictureFormat::svg);
  require_range("the streamlines are", request.streamlines, std::size_t(1), most_figure_lines);
  if (request.results.empty() && (choice.mass || !choice.maps.empty()))
    require_range("the degree is", choice.lmax, least_figure_degree, largest_surface_degree);
  if (of_one_map(request.kind) && request.results.empty() && (choice.maps.size() != 1 || choice.mass))
    throw Error(Fault::bad_argument, "this figure is of one map: harmonic, stretch, smooth or flow");
  const Body body = make_body(ClosedSurface::from(std::move(request.mesh)), {}, 1);
  std::vector<std::string> left_out;
  plot::Canvas page = draw({request, body, backend, monitor}, left_out);
  return {std::move(page), std::move(left_out)};
}

} // namespace cowgpu
