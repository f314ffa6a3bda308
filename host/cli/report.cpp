#include "host/cli/commands.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/io/foreign_file.hpp"
#include "host/io/mesh_source.hpp"
#include "host/io/result_json.hpp"
#include "host/io/shown.hpp"
#include "host/io/surface_file.hpp"
#include "host/map/map_method.hpp"
#include "host/report/page.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace cowgpu::cli {
namespace {

using nlohmann::json;

// Beyond, the page would take seconds to open: bodies to this order have 66,000 vertices.
constexpr int largest_order = 128;
constexpr int default_order = 32;
constexpr std::size_t largest_mesh = 120000; // faces, 18 bytes each in the file

struct Options {
  std::string result, mesh, output;
  std::vector<std::string> physics;
  int order = -1;
};

struct Source {
  json document;
  std::vector<SurfaceFile> surfaces;
  RawMesh mesh; // empty where none is known
};

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

/// A document of findings. It may be any JSON object that names its schema.
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

/// The distances of all orders from the mesh.
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

std::string human(std::uintmax_t bytes) {
  return bytes < 1000000 ? fmt::format("{:.0f} kB", double(bytes) / 1e3)
                         : fmt::format("{:.1f} MB", double(bytes) / 1e6);
}

void run(const Options& options, const Common& common) {
  const auto start = Clock::now();
  if (!options.output.ends_with(".html"))
    throw Error(Fault::bad_argument,
                fmt::format("-o {}: the page is HTML, and its name must end in .html", options.output));
  refuse_same_file(options.result, options.output);
  refuse_mesh_as_output(options.mesh, options.output);
  for (const std::string& path : options.physics) refuse_same_file(path, options.output);
  const std::string page = read_page();
  AtomicFile file(options.output);

  Source source{result_json::read(options.result), {}, {}};
  source.surfaces = read_surfaces(options.result, source.document);
  PageDocument document;
  document.result = &source.document;
  document.command = common.command;
  for (const std::string& path : options.physics) document.physics.push_back(read_findings(path));

  int most = 0;
  for (const SurfaceFile& surface : source.surfaces) most = std::max(most, surface.expansion.coefficients.lmax);
  if (options.order > most && !source.surfaces.empty())
    throw Error(Fault::bad_argument, fmt::format("--order {}: {} holds degrees 0 to {}; expand to a higher lmax",
                                                 options.order, options.result, most));
  const int order = options.order >= 0 ? options.order : std::min(most, default_order);
  document.grid = make_grid(GridKind::clenshaw_curtis, page_resolution(order));

  std::string note;
  const auto backend = open_backend(common, &note);
  if (!note.empty() && !common.quiet) say(fmt::format("cowgpu: {}\n", note));
  ConsoleMonitor monitor(common.style());
  std::unique_ptr<DistanceField> field;
  if (!options.mesh.empty()) {
    source.mesh = load_mesh(options.mesh);
    place(source.mesh, result_json::placement(options.result, source.document));
    field = backend->distance_field(source.mesh.vertices, source.mesh.faces);
    document.mesh_name = source.mesh.name;
    const auto hash = "/mesh/sha256"_json_pointer;
    if (!source.document.contains(hash) || source.document.at(hash) != source.mesh.sha256) {
      document.notes.push_back(fmt::format("{} has another SHA-256 than the mesh that was expanded", source.mesh.name));
      say(fmt::format("cowgpu: warning: {}: distances are to another body\n", document.notes.back()));
    }
    if (source.mesh.faces.size() <= largest_mesh) {
      document.vertices = source.mesh.vertices;
      document.faces = source.mesh.faces;
    } else
      document.notes.push_back(
          fmt::format("the mesh itself is not in this page: it has {} triangles, and pages carry {}",
                      source.mesh.faces.size(), largest_mesh));
  }
  for (const SurfaceFile& file_ : source.surfaces) {
    PageSurface surface;
    surface.name = file_.name;
    surface.expansion = &file_.expansion;
    surface.order = std::min(order, file_.expansion.coefficients.lmax);
    for (const SurfaceFields fields : {SurfaceFields::xyz, SurfaceFields::f})
      if (field && (fields == SurfaceFields::xyz || file_.expansion.signed_dphi))
        surface.distances[std::size_t(fields)] =
            distances(file_.expansion, fields, surface.order, document.grid, *field, *backend, monitor);
    document.surfaces.push_back(std::move(surface));
  }
  if (document.surfaces.empty())
    document.notes.push_back("the result has no expansion of the surface, so no body is rebuilt here; "
                             "`cowgpu expand MESH --of mass,stretch -o FILE.json` makes one");
  write_page(page, document, file);
  file.commit();
  monitor.clear();
  if (!common.quiet) {
    std::error_code failed;
    const auto bytes = std::filesystem::file_size(options.output, failed);
    say(fmt::format("cowgpu: wrote {}{} in {:.1f} s\n", options.output, failed ? "" : " (" + human(bytes) + ")",
                    seconds_since(start)));
  }
}

} // namespace

void add_report(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand(
      "report", "A result as one HTML file: the body at every order, its map, spectra, tables; it needs no network");
  command->add_option("result", options->result, "FILE.json of `cowgpu expand`")
      ->type_name("RESULT")
      ->required()
      ->check(not_empty());
  command
      ->add_option("--mesh", options->mesh, "The true body, to show beside and to take distances from. " + mesh_help())
      ->type_name("MESH");
  command
      ->add_option("--physics", options->physics,
                   "What `cowgpu tensors --json`, `radiate --json` and the like printed; several times for several")
      ->type_name("FILE.json")
      ->allow_extra_args(false);
  command
      ->add_option("--order", options->order,
                   fmt::format("The largest order of the body ({} or the expansion's)", default_order))
      ->check(in_range(0, largest_order))
      ->type_name("L");
  command->add_option("-o,--output", options->output, "The page, FILE.html")
      ->type_name("FILE")
      ->required()
      ->check(not_empty());
  add_common_options(*command, common);
  command->footer("Examples: cowgpu expand --of mass,stretch --lmax 64 -o cow.json\n"
                  "          cowgpu tensors --json > tensors.json\n"
                  "          cowgpu report cow.json --mesh builtin:cow --physics tensors.json -o cow.html");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
