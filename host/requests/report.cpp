#include "host/requests/report.hpp"

#include "host/bounds.hpp"
#include "host/error.hpp"
#include "host/io/foreign_file.hpp"
#include "host/io/mesh_values_read.hpp"
#include "host/io/result_json.hpp"
#include "host/io/shown.hpp"
#include "host/map/map_method.hpp"
#include "host/mesh/topology.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu {
namespace {

using nlohmann::json;

constexpr std::size_t largest_mesh = 120000; // faces of a mesh in the page, 18 bytes each in the file

std::vector<SurfaceFile> read_surfaces(const std::string& path, const json& document) {
  std::vector<SurfaceFile> files;
  const json& expansions = result_json::member(path, document, "expansions");
  if (!expansions.is_object())
    throw Error(Fault::file_format, fmt::format("{}: the member 'expansions' must be an object", path));
  for (const MapMethod first : {MapMethod::stretch, MapMethod::harmonic, MapMethod::smooth, MapMethod::flow})
    if (expansions.contains(name(first))) files.push_back(read_surface(path, std::string(name(first))));
  for (const auto& [key, value] : expansions.items()) {
    const auto known = [&key = key](const SurfaceFile& file) { return file.name == key; };
    if (key != "mass" && std::none_of(files.begin(), files.end(), known)) files.push_back(read_surface(path, key));
  }
  return files;
}

// A document of findings. It may be any JSON object that names its schema.
nlohmann::ordered_json read_findings(const std::string& path) {
  nlohmann::ordered_json document = result_json::parse_in_order(path, read_input_file(path));
  const std::string schema = document.is_object() && document.contains("schema") && document["schema"].is_string()
                                 ? document["schema"].get<std::string>()
                                 : "";
  if (schema.rfind("cowgpu.", 0) != 0)
    throw Error(Fault::file_format, fmt::format("{}: this JSON is not a document of cowgpu; take what `cowgpu tensors "
                                                "--json`, `radiate --json` and the like print",
                                                path));
  for (const char* member : {"input", "units", "notes"})
    if (!document.contains(member))
      throw Error(Fault::file_format,
                  fmt::format("{}: a {} has no findings to show (no member '{}'); take what `cowgpu tensors --json`, "
                              "`radiate --json` and the like print",
                              path, shown(schema, 60), member));
  if (!document["input"].is_object() || !document["units"].is_object() || !document["notes"].is_array())
    throw Error(
        Fault::file_format,
        fmt::format("{}: in a document of findings 'input' and 'units' are objects and 'notes' is a list", path));
  return document;
}

// The distances of all orders from the mesh.
std::vector<PageDistances> distances(const SurfaceExpansion& expansion, SurfaceFields fields, int largest,
                                     const SphereGrid& grid, DistanceField& field, Backend& backend, Monitor& monitor) {
  std::vector<PageDistances> orders;
  for (int order = 0; order <= largest; ++order) {
    check_stop(monitor);
    monitor.progress("distances to the mesh", double(order) / (largest + 1));
    const TriangleSurface surface = reconstruct(expansion, fields, order, grid, backend, silent_monitor());
    orders.push_back(page_distances(grid, field.closest(surface.vertices, {false}, silent_monitor()).distance));
  }
  return orders;
}

// The mesh, placed as the result was, with the distance from it.
std::unique_ptr<DistanceField> add_mesh(RawMesh mesh, const std::string& file, Backend& backend, Report& report) {
  PageDocument& document = report.document;
  report.mesh = std::move(mesh);
  place(report.mesh, result_json::placement(file, report.result));
  document.mesh_name = report.mesh.name;
  const auto hash = "/mesh/sha256"_json_pointer;
  if (!report.result.contains(hash) || report.result.at(hash) != report.mesh.sha256) {
    report.warning = fmt::format("{} has another SHA-256 than the mesh that was expanded", called(report.mesh));
    document.notes.push_back(report.warning);
  }
  if (report.mesh.faces.size() <= largest_mesh) {
    document.vertices = report.mesh.vertices;
    document.faces = report.mesh.faces;
  } else
    document.notes.push_back(fmt::format("the mesh itself is not in this page: it has {} triangles, and pages carry {}",
                                         report.mesh.faces.size(), largest_mesh));
  return backend.distance_field(report.mesh.vertices, report.mesh.faces);
}

// The values on the mesh, which is there. A page without the mesh has no place for them.
void add_values(const std::string& file, Report& report) {
  report.values = read_mesh_values(file);
  put_on(report.values, report.mesh.vertices, report.mesh.faces);
  if (report.values.columns.empty())
    throw Error(Fault::file_format, fmt::format("{}: there are no values beside the places", file));
  if (report.document.faces.empty())
    report.document.notes.push_back("the values on the mesh are not in this page, as the mesh itself is not");
  else
    report.document.values = &report.values;
}

// The largest order that is shown.
int order_of(const ReportRequest& request, const Report& report) {
  int most = 0;
  for (const SurfaceFile& surface : report.surfaces) most = std::max(most, surface.expansion.coefficients.lmax);
  if (!request.order) return std::min(most, usual_report_order);
  require_range("the largest order is", *request.order, 0, largest_report_order);
  if (*request.order > most && !report.surfaces.empty())
    throw Error(Fault::bad_argument, fmt::format("the order {} cannot be shown: {} holds degrees 0 to {}; expand to a "
                                                 "higher lmax",
                                                 *request.order, request.result, most));
  return *request.order;
}

} // namespace

std::unique_ptr<Report> make_report(ReportRequest request, Backend& backend, Monitor& monitor) {
  if (!request.values.empty() && !request.mesh)
    throw Error(Fault::bad_argument,
                fmt::format("--values {}: name the mesh that they were computed on with --mesh", request.values));
  auto report = std::make_unique<Report>();
  PageDocument& document = report->document;
  report->result = result_json::read(request.result);
  report->surfaces = read_surfaces(request.result, report->result);
  document.result = &report->result;
  document.command = std::move(request.command);
  for (const std::string& path : request.physics) document.physics.push_back(read_findings(path));
  const int order = order_of(request, *report);
  document.grid = make_grid(GridKind::clenshaw_curtis, page_resolution(order));
  std::unique_ptr<DistanceField> field;
  if (request.mesh) field = add_mesh(std::move(*request.mesh), request.result, backend, *report);
  if (!request.values.empty()) add_values(request.values, *report);
  for (const SurfaceFile& file : report->surfaces) {
    PageSurface surface;
    surface.name = file.name;
    surface.expansion = &file.expansion;
    surface.order = std::min(order, file.expansion.coefficients.lmax);
    for (const SurfaceFields fields : {SurfaceFields::xyz, SurfaceFields::f})
      if (field && (fields == SurfaceFields::xyz || file.expansion.signed_dphi))
        surface.distances[std::size_t(fields)] =
            distances(file.expansion, fields, surface.order, document.grid, *field, backend, monitor);
    document.surfaces.push_back(std::move(surface));
  }
  if (document.surfaces.empty())
    document.notes.push_back("the result has no expansion of the surface, so no body is rebuilt here; "
                             "`cowgpu expand MESH --of mass,stretch -o FILE.json` makes one");
  return report;
}

} // namespace cowgpu
