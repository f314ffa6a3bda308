#include "host/cli/tip_input.hpp"

#include "host/cli/expansion_words.hpp"
#include "host/cli/order_list.hpp"
#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/io/coefficient_file.hpp"
#include "host/io/coefficient_metadata.hpp"
#include "host/io/result_json.hpp"
#include "host/io/surface_file.hpp"
#include "host/requests/expand_surfaces.hpp"
#include "host/spectrum/convert.hpp"
#include "host/spectrum/expand_surface.hpp"
#include "host/requests/surface_source.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::cli {
namespace {

using namespace physics;

// Contact points are a matter of triangles: finer ones than a picture needs.
int tip_resolution(int order) {
  return std::max(default_resolution(order), 128);
}

int resolution_of(const TipChoice& choice, int order) {
  return choice.resolution > 0 ? choice.resolution : tip_resolution(order);
}

[[noreturn]] void not_a_surface(const std::string& file, const std::string& what) {
  throw Error(
      Fault::file_format,
      fmt::format("{} holds {}, and tipping needs coefficients of a surface: fields f_r, f_dtheta, f_dphi, x, y, "
                  "z, as `cowgpu expand --of stretch -o FILE` writes them; or take the mesh",
                  file, what));
}

// Any format: the columns of `cowgpu expand -o FILE.csv` are named after their expansion.
CoefficientSet read_surface_set(const std::string& file, const std::string& of) {
  CoefficientSet set = read_coefficient_set(file, of);
  if (!of.empty() || set.kind != CoefficientKind::field) return set;
  std::vector<std::string> there;
  for (const std::string& field : set.names)
    if (field.ends_with("_f_r")) there.push_back(field.substr(0, field.size() - 4));
  if (there.empty()) return set;
  const bool stretch = std::find(there.begin(), there.end(), "stretch") != there.end();
  if (there.size() > 1 && !stretch)
    throw Error(Fault::bad_argument, fmt::format("{} has several expansions of a surface: {}; choose one with --of",
                                                 file, fmt::join(there, ", ")));
  return read_coefficient_set(file, stretch ? "stretch" : there.front());
}

SurfaceSource source_of_set(const std::string& file, const std::string& of, bool& metric) {
  const CoefficientSet set = read_surface_set(file, of);
  if (set.kind != CoefficientKind::field)
    not_a_surface(file, fmt::format("coefficients of a mass ({})", name(set.kind)));
  if (set.names != std::vector<std::string>(surface_field_names.begin(), surface_field_names.end()))
    not_a_surface(file, fmt::format("coefficients of {} field{}{}", set.fields, set.fields == 1 ? "" : "s",
                                    set.names[0].empty() ? "" : fmt::format(" ({} ...)", set.names[0])));
  SurfaceSource source;
  source.name = of.empty() ? "surface" : of;
  source.expansion.coefficients = orthonormal(set);
  source.expansion.origin = set.origin.value_or(Vec3::Zero());
  source.expansion.mean_dtheta = remark_number(set, file, "removed_mean_f_dtheta", 0);
  source.expansion.mean_dphi = remark_number(set, file, "removed_mean_f_dphi", 0);
  source.mesh = set.provenance.mesh;
  source.notes = set.notes;
  if (!(spherical_radius(source.expansion) > 0))
    throw Error(Fault::file_format,
                fmt::format("{}: the coefficient (0, 0) of f_r must be above 0: it gives the mean distance", file));
  metric = set.length_unit == "m";
  return source;
}

bool holds_expansions(const std::string& file) {
  if (!is_result_file(file)) return false;
  const nlohmann::json document = result_json::parse(file);
  return document.is_object() && document.contains("expansions");
}

void scale(SurfaceExpansion& expansion, double factor) {
  SphereCoefficients& a = expansion.coefficients;
  const std::size_t count = SphereCoefficients::count(a.lmax);
  for (const std::size_t field : {0, 3, 4, 5})
    for (std::size_t i = 0; i < count; ++i) a.values[field * count + i] *= factor;
  expansion.origin *= factor;
}

void check_orders(const TipInput& input, const TipChoice& choice, const std::string& file) {
  const int largest = input.orders.empty() ? 0 : *std::max_element(input.orders.begin(), input.orders.end());
  const int lmax = input.expansion->coefficients.lmax;
  if (largest > lmax)
    throw Error(Fault::bad_argument,
                fmt::format("order {} cannot be rebuilt: {} holds degrees 0 to {}", largest, file, lmax));
  if (choice.resolution > 0 && choice.resolution < largest)
    throw Error(Fault::bad_argument, fmt::format("--resolution {} cannot show order {}; it must be at least the order",
                                                 choice.resolution, largest));
  check_memory(rebuild_memory(largest, resolution_of(choice, largest), *input.backend), *input.backend,
               "lower --order or --resolution");
}

TriangleSurface order_surface(const TipInput& input, const TipChoice& choice, int order, Monitor& monitor) {
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, resolution_of(choice, order));
  TriangleSurface surface = reconstruct(*input.expansion, input.fields, order, grid, *input.backend, monitor);
  surface.name = fmt::format("order {}", order);
  return surface;
}

void from_coefficients(const BodyRequest& request, const TipChoice& choice, TipInput& input, Monitor& monitor) {
  const std::string& file = request.mesh;
  refuse_placing(request);
  if (choice.lmax >= 0)
    throw Error(Fault::bad_argument, fmt::format("--lmax is for meshes: {} holds an expansion already", file));
  bool metric = false;
  SurfaceSource source;
  if (holds_expansions(file)) {
    source = load_surface({file, choice.of, choice.mesh, -1}, 0, *input.backend, monitor);
    metric = source.placement.units.stated;
  } else {
    if (!choice.mesh.empty())
      throw Error(Fault::bad_argument, fmt::format("--mesh: only the JSON of `cowgpu expand` says how its mesh was "
                                                   "placed, and {} is another file",
                                                   file));
    source = source_of_set(file, choice.of, metric);
  }
  if (metric && request.length_unit)
    throw Error(Fault::bad_argument, fmt::format("--length-unit: {} is in metres already", file));
  const double density = request.density.value_or(1), metre = request.length_unit.value_or(1);
  if (!(density > 0))
    throw Error(Fault::bad_argument,
                fmt::format("--density {}: the body weighs nothing or less; it must be above 0", density));
  const bool stated = metric || request.length_unit;
  const Units units{metre, stated ? density * metre * metre * metre : 1, stated};
  scale(source.expansion, metre);
  input.head = {
      fmt::format("coefficients {}, surface {} to degree {}", file, source.name, source.expansion.coefficients.lmax),
      "coefficients", file, "", source.notes};
  if (const std::string note = density_note(request, units); !note.empty()) input.head.notes.push_back(note);
  input.expansion = std::move(source.expansion);
  input.expansion_name = source.name;
  check_orders(input, choice, file);
  if (source.body) {
    const Body& body = *source.body;
    RawMesh mesh = body.surface.mesh();
    for (Vec3& v : mesh.vertices) v *= metre;
    input.full = solid_body(make_body(ClosedSurface::from(std::move(mesh)), {}, density));
    input.full.units = units;
    input.full_is = "the mesh " + choice.mesh;
    return;
  }
  const int lmax = input.expansion->coefficients.lmax;
  check_memory(rebuild_memory(lmax, resolution_of(choice, lmax), *input.backend), *input.backend,
               "lower --resolution, or name the body with --mesh");
  const TriangleSurface surface = order_surface(input, choice, lmax, monitor);
  std::string note;
  input.full = smooth_body(surface, density * std::abs(volume(surface.vertices, surface.faces)), note);
  input.full.units = units;
  input.full_is = fmt::format("order {}, the last of the file: --mesh names the true body", lmax);
}

void from_mesh(const BodyRequest& request, const TipChoice& choice, TipInput& input, const Common& common,
               Monitor& monitor) {
  if (!choice.mesh.empty())
    throw Error(Fault::bad_argument, fmt::format("--mesh is for coefficients: {} is a mesh", request.mesh));
  if (input.orders.empty() && (!choice.of.empty() || choice.lmax >= 0 || choice.resolution > 0))
    throw Error(Fault::bad_argument, "--of, --lmax and --resolution are about orders of the expansion; add --order");
  const int largest = input.orders.empty() ? 0 : *std::max_element(input.orders.begin(), input.orders.end());
  const int lmax = choice.lmax >= 0 ? choice.lmax : std::max(largest, default_lmax);
  if (largest > lmax)
    throw Error(Fault::bad_argument, fmt::format("order {} is beyond --lmax {}; raise --lmax", largest, lmax));
  ExpansionChoice maps;
  if (!input.orders.empty()) {
    maps = parse_expansions(choice.of.empty() ? "stretch" : choice.of, "default", "", lmax);
    if (maps.mass || maps.maps.size() != 1)
      throw Error(Fault::bad_argument,
                  fmt::format("--of {}: a body is rebuilt over one map: harmonic, stretch, smooth or flow", choice.of));
  }
  const LoadedMass loaded = load_mass(request, Motion::held, monitor);
  input.head = subject(loaded);
  const Body& body = *loaded.mesh;
  input.full = solid_body(body);
  input.full_is = "the mesh";
  if (std::any_of(body.parts.begin(), body.parts.end(), [](const Part& part) { return part.density < 0; }))
    input.head.notes.push_back(
        "parts of negative density are holes: the body neither stands on them nor is pushed at them");
  if (input.orders.empty()) return;
  std::string note;
  input.backend = open_backend(common, &note);
  if (!note.empty()) input.head.notes.push_back(note);
  check_memory(surfaces_memory(maps, body.surface.faces().size(), *input.backend), *input.backend, "lower --lmax");
  std::vector<SurfaceResult> results = expand_surfaces(maps, false, body, *input.backend, monitor);
  check_surfaces(results);
  SurfaceResult result = std::move(results.front());
  input.expansion_name = name(result.of);
  input.expansion = std::move(result.expansion);
  for (const std::string& sentence : result.quality.sentences) input.head.notes.push_back("map: " + sentence);
  if (!body.parts.empty())
    input.head.notes.push_back("orders are of the outer surface, uniform, with the mass of all parts");
  check_orders(input, choice, request.mesh);
}

} // namespace

TipInput load_tip_input(const BodyRequest& request, const TipChoice& choice, const Common& common) {
  TipInput input;
  input.fields = parse_fields(choice.fields);
  for (const int order : parse_orders(choice.orders, "full"))
    if (order != whole_mesh) input.orders.push_back(order);
  ConsoleMonitor monitor(common.style());
  if (!is_coefficient_file(request.mesh)) {
    from_mesh(request, choice, input, common, monitor);
    return input;
  }
  std::string note;
  input.backend = open_backend(common, &note);
  from_coefficients(request, choice, input, monitor);
  if (!note.empty()) input.head.notes.push_back(note);
  return input;
}

RigidBody order_body(const TipInput& input, const TipChoice& choice, int order, Monitor& monitor, std::string& note) {
  return smooth_body(order_surface(input, choice, order, monitor), input.full.mass, note);
}

RigidBody ball_like(const RigidBody& body, double volume) {
  const SphereTriangulation sphere = icosphere(4);
  const double radius = std::cbrt(3 * volume / (4 * std::numbers::pi));
  TriangleSurface ball;
  ball.faces = sphere.faces;
  for (const Vec3& direction : sphere.directions) ball.vertices.emplace_back(body.centre + radius * direction);
  std::string note;
  return smooth_body(ball, body.mass, note);
}

} // namespace cowgpu::cli
