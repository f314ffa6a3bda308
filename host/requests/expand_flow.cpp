#include "host/requests/expand_flow.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/triangle_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {
namespace {

constexpr double flow_tolerance = 1e-6;

std::uint64_t grid_points(int degree) {
  return 2 * std::uint64_t(degree + 1) * std::uint64_t(degree + 1);
}

// Each meaning fills in flow, map, expansion and report.

void level_set(double time, int grid_degree, ExpandSurfaceOptions options, const ManifoldSurface& surface,
               Backend& backend, Monitor& monitor, SurfaceResult& result) {
  FlowResult& flow = *result.flow;
  options.grid_degree = std::max(grid_degree, surface_grid_degree(options.lmax));
  LevelSetExpansion found = expand_level_set(surface.closed().mesh(), time, options, backend, monitor);
  flow.time = found.time;
  flow.star = found.star;
  flow.level_set = found.level_set;
  flow.uncertainty = std::move(found.uncertainty);
  flow.failure = std::move(found.failure);
  flow.sutures = found.sutures;
  std::vector<std::string> notes = std::move(found.notes);
  result.expansion = std::move(found.expansion);
  result.report = std::move(found.report);
  const auto start = Clock::now();
  const FlowPoints ends = flow_vertices(surface, flow.time, backend, monitor, flow.points);
  result.map = direction_map(ends.positions, options.origin);
  result.map.notes.insert(result.map.notes.end(), notes.begin(), notes.end());
  result.map_seconds = seconds_since(start);
}

SheetExpansion signed_sheets(const FlowChoice& choice, double time, const ExpandSurfaceOptions& options,
                             const ManifoldSurface& surface, Backend& backend, Monitor& monitor) {
  const auto flow = backend.distance_flow(surface.vertices(), surface.faces());
  return expand_sheets(surface.closed().mesh(), time, choice.refinements, flow_tolerance, options, *flow, backend,
                       monitor);
}

void sheets(const FlowChoice& choice, const ExpandSurfaceOptions& options, const ManifoldSurface& surface,
            Backend& backend, Monitor& monitor, SurfaceResult& result) {
  FlowResult& flow = *result.flow;
  flow.star = find_star_shape_time(surface.closed().mesh(), options.origin, backend, monitor);
  flow.time = flow_time(choice.time, flow.star);
  SheetExpansion found = signed_sheets(choice, flow.time, options, surface, backend, monitor);
  flow.points = found.flow;
  flow.sheets = std::move(found.sheets);
  flow.uncertainty = std::move(found.uncertainty);
  result.expansion = std::move(found.expansion);
  result.report = std::move(found.report);
  const auto start = Clock::now();
  FlowReport of_vertices;
  result.map =
      direction_map(flow_vertices(surface, flow.time, backend, monitor, of_vertices).positions, options.origin);
  result.map_seconds = seconds_since(start);
}

void steps(const FlowChoice& choice, const ExpandSurfaceOptions& options, const ManifoldSurface& surface,
           Backend& backend, Monitor& monitor, SurfaceResult& result) {
  FlowResult& flow = *result.flow;
  const RawMesh& mesh = surface.closed().mesh();
  flow.star = find_star_shape_time(mesh, options.origin, backend, monitor);
  flow.time = flow_time(choice.time, flow.star);
  const auto start = Clock::now();
  result.map = stepped_flow_map(mesh, options.origin, flow.time, choice.step, backend, monitor);
  result.map_seconds = seconds_since(start);
  result.closest_point = options.closest_point;
  result.expansion =
      expand_surface(surface.vertices(), surface.faces(), result.map, options, backend, monitor, &result.report);
  SheetExpansion found = signed_sheets(choice, flow.time, options, surface, backend, monitor);
  flow.points = found.flow;
  flow.sheets = std::move(found.sheets);
  flow.converged = ConvergedTable{std::move(found.expansion), std::move(found.uncertainty)};
}

} // namespace

void expand_flow(const ExpansionChoice& choice, bool estimate_aliasing, const ManifoldSurface& surface,
                 const Vec3& origin, Backend& backend, Monitor& monitor, SurfaceResult& result) {
  FlowResult& flow = result.flow.emplace();
  const FlowChoice& how = choice.flow;
  const bool stepped = how.meaning == FlowMeaning::steps, in_sheets = how.meaning == FlowMeaning::sheets;
  if (how.time > 0) check_flow_time(how.time, bounding_box(surface.vertices(), surface.faces()));
  flow.meaning = stepped ? "paper" : in_sheets ? "sheets" : "level-set"; // the words of results
  flow.time_choice = choice.reading.recipe == "paper" ? "paper" : how.time > 0 ? "given" : "auto";
  ExpandSurfaceOptions options;
  options.lmax = choice.lmax;
  options.origin = origin;
  options.closest_point = choice.reading.closest_point;
  options.signed_dphi = choice.reading.signed_dphi;
  options.estimate_aliasing = estimate_aliasing || choice.reading.estimate_aliasing;
  if (stepped)
    steps(how, options, surface, backend, monitor, result);
  else if (in_sheets)
    sheets(how, options, surface, backend, monitor, result);
  else
    level_set(how.time, how.grid_degree, options, surface, backend, monitor, result);
  if (flow.time < flow.star.upper) result.map.notes.push_back(star_shape_sentence(flow.star, flow.time));
}

MemoryNeed expand_flow_memory(const FlowChoice& choice, int lmax, std::span<const Vec3> vertices,
                              std::span<const Face> faces, const Backend& backend) {
  const std::uint64_t coefficients = 6 * 16 * SphereCoefficients::count(lmax);
  if (choice.meaning == FlowMeaning::level_set) {
    // A grid of its own: positions, the six fields, and a batch of rays.
    MemoryNeed need = backend.distance_field(vertices, faces)->memory(std::uint64_t(1) << 18);
    need.host += grid_points(std::max(choice.grid_degree, surface_grid_degree(lmax))) * 9 * sizeof(double);
    need.host += 3 * coefficients; // coefficients on the three grids
    return need;
  }
  // Paths and positions of the finest vertices, its faces, and caps of these.
  const std::uint64_t times = std::uint64_t(1) << (2 * choice.refinements);
  MemoryNeed need = backend.distance_flow(vertices, faces)->memory(times * vertices.size());
  need.host += times * (vertices.size() * 100 + faces.size() * 120);
  need.host += (std::uint64_t(choice.refinements) + 2) * coefficients; // each level's
  // The six fields on their grid, and on the coarser one that shows its error.
  need.host += grid_points(sheets_grid_degree(lmax)) * 6 * 2 * sizeof(double);
  return need;
}

FlowPoints flow_vertices(const ManifoldSurface& surface, double time, Backend& backend, Monitor& monitor,
                         FlowReport& report) {
  const auto flow = backend.distance_flow(surface.vertices(), surface.faces());
  FlowOptions options;
  options.time = time;
  options.tolerance = flow_tolerance;
  return flow->flow(surface.vertices(), vertex_normals(surface.vertices(), surface.faces()), options, monitor, &report);
}

StarShapeTime find_star_shape_time(const RawMesh& mesh, const Vec3& origin, Backend& backend, Monitor& monitor) {
  return star_shape_time(mesh.vertices, mesh.faces, origin,
                         usual_star_shape_tolerance(mesh.vertices, mesh.faces, origin), backend, monitor);
}

double flow_time(double given, const StarShapeTime& star) {
  return given > 0 ? given : star.upper;
}

void check_flow_time(double time, const Box& box) {
  const double diagonal = (box.max - box.min).norm();
  if (!(time >= 1e-9 * diagonal && time <= 1e4 * diagonal))
    throw Error(Fault::bad_argument,
                fmt::format("a time of {:.6g} for a body whose box has the diagonal {:.6g}: times go "
                            "from 1e-9 of that to 1e4 times that, beyond which nothing but rounding "
                            "is left",
                            time, diagonal));
}

} // namespace cowgpu
