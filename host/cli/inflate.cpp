#include "host/cli/commands.hpp"
#include "host/cli/drawing.hpp"
#include "host/cli/mend_options.hpp"
#include "host/cli/surface_outputs.hpp"
#include "host/figures/scene.hpp"
#include "host/requests/expand_flow.hpp"

#include "host/clock.hpp"
#include "host/error.hpp"
#include "host/flow/level_surface.hpp"
#include "host/io/png.hpp"
#include "host/io/shown.hpp"
#include "host/mesh/audit.hpp"
#include "host/mesh/winding_notes.hpp"
#include "host/number.hpp"
#include "host/report/flow_result.hpp"
#include "host/report/json_parts.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace cowgpu::cli {
namespace {

constexpr const char* star_word = "star";

struct Options {
  std::string mesh = "builtin:cow", levels, origin = "com", output, format, picture, view = "28,14";
  Mending mending;
  int cells = 128, width = 480, height = 400;
  bool star = false, json = false;
};

// A distance to inflate by, and what the user calls it.
struct Level {
  OutputKey key;
  double distance = 0; // 0: the star-shape time, until it is known
};

struct Inflated {
  Level level;
  Audit audit;
  LevelSurfaceReport report;
  LevelSurfaceError error;
  TriangleSurface surface;
  std::string output;
};

std::vector<Level> parse_levels(const std::string& text) {
  std::vector<Level> levels;
  std::istringstream words(text + ",");
  for (std::string word; std::getline(words, word, ',');) {
    Level level{{word, "inflated-" + word}, 0};
    if (word != star_word) {
      level.distance = read_number(word).value_or(0);
      if (!(level.distance > 0))
        throw Error(
            Fault::bad_argument,
            fmt::format("--levels {}: \"{}\" is not a level; levels are numbers above 0 in the mesh's length unit, "
                        "and star for the least that makes the body star-shaped, separated by commas",
                        shown(text), shown(word)));
    }
    const bool known = std::any_of(levels.begin(), levels.end(), [&](const Level& l) { return l.key.text == word; });
    if (!known) levels.push_back(level);
  }
  return levels;
}

nlohmann::ordered_json level_json(const Inflated& body) {
  const Audit& a = body.audit;
  return {{"level", body.level.distance},
          {"name", body.level.key.text},
          {"volume", a.volume ? nlohmann::ordered_json(*a.volume) : nlohmann::ordered_json()},
          {"area", a.area},
          {"volume_error", body.error.volume_error},
          {"area_error", body.error.area_error},
          {"vertices", a.vertices},
          {"faces", a.faces},
          {"shells", a.components},
          {"genus", a.genus ? nlohmann::ordered_json(*a.genus) : nlohmann::ordered_json()},
          {"closed", a.closed},
          {"cell", body.report.cell},
          {"queries", body.report.queries},
          {"largest_residual", body.report.largest_residual},
          {"output", body.output.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(body.output)},
          {"seconds", body.report.seconds}};
}

// A value with its error, and no digits beyond that.
std::string known_text(double value, double error) {
  const double parts = std::abs(value) / error;
  const int digits = std::isfinite(parts) && parts > 0 ? std::clamp(int(std::ceil(std::log10(parts))) + 1, 1, 8) : 8;
  return fmt::format("{:.{}g} +- {:.1e}", value, digits, error);
}

// What is to be said of a body whose volume or area the cubes leave open by more than a hundredth.
std::string coarse_note(const Inflated& body, int cells) {
  const double part = std::max(body.error.volume_error / std::abs(body.audit.volume.value_or(std::nan(""))),
                               body.error.area_error / body.audit.area);
  if (part <= 0.01) return {};
  const double wanted = std::ceil(cells * body.report.cell / body.level.distance);
  const std::string cure = cells >= 1024    ? "take a longer level"
                           : wanted > cells ? fmt::format("take --cells {:.0f}", std::min(wanted, 1024.))
                                            : fmt::format("take --cells {}", std::min(2 * cells, 1024));
  return fmt::format(
      "the level {:.6g} is found in cubes of {:.3g}, and its volume and area are known only to {:.2g} %; {}",
      body.level.distance, body.report.cell, 100 * part, cure);
}

void write_report(const Options& options, const Common& common, const Body& body, const DeviceFacts& device,
                  const std::vector<std::string>& notes, const std::optional<StarShapeTime>& star, double star_seconds,
                  const std::vector<Inflated>& bodies) {
  const RawMesh& mesh = body.surface.mesh();
  const Vec3& o = body.origin;
  if (options.json) {
    nlohmann::ordered_json levels = nlohmann::ordered_json::array();
    for (const Inflated& b : bodies) levels.push_back(level_json(b));
    const nlohmann::ordered_json all = {
        {"schema", "cowgpu.inflate.v1"},
        {"program", program_json()},
        {"command", common.command},
        {"created", utc_now()},
        {"mesh",
         {{"name", mesh.name},
          {"sha256", mesh.sha256},
          {"vertices", mesh.vertices.size()},
          {"faces", mesh.faces.size()},
          {"volume", body.volume},
          {"area", body.area}}},
        {"origin", {o.x(), o.y(), o.z()}},
        {"origin_kind", body.origin_kind},
        {"device", device_json(device)},
        {"notes", notes},
        {"star_shape", star ? star_shape_json(*star) : nlohmann::ordered_json()},
        {"levels", levels},
        {"picture", options.picture.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(options.picture)},
        {"timings", {{"star_shape", star_seconds}}}};
    write_stdout(json_text(all) + "\n");
    return;
  }
  write_stdout(mesh_line(mesh) + "\n");
  for (const std::string& note : notes) write_stdout("note: " + note + "\n");
  write_stdout("device: " + device_line(device) + "\n");
  if (star)
    write_stdout(fmt::format("{}; origin ({:.9g}, {:.9g}, {:.9g}) ({}), {} closest points, {:.3f} s\n",
                             star_shape_text(*star), o.x(), o.y(), o.z(), body.origin_kind, star->queries,
                             star_seconds));
  if (bodies.empty()) return;
  write_stdout("the body inflated by a distance, in the mesh's length unit\n");
  write_stdout(fmt::format("  {:>10}  {:>20}  {:>20}  {:>6}  {:>5}  {:>9}  {:>9}  {:>8}\n", "level", "volume", "area",
                           "shells", "genus", "triangles", "cell", "seconds"));
  for (const Inflated& b : bodies)
    write_stdout(fmt::format("  {:>10.6g}  {:>20}  {:>20}  {:>6}  {:>5}  {:>9}  {:>9.3g}  {:>8.3f}\n", b.level.distance,
                             known_text(b.audit.volume.value_or(std::nan("")), b.error.volume_error),
                             known_text(b.audit.area, b.error.area_error), b.audit.components,
                             b.audit.genus ? fmt::format("{}", *b.audit.genus) : "-", b.audit.faces, b.report.cell,
                             b.report.seconds));
}

Inflated inflate(const Level& level, const Options& options, const Body& body, DistanceField& field,
                 SurfaceOutputs& outputs, Monitor& monitor) {
  Inflated result;
  result.level = level;
  result.surface =
      level_surface(field, body.box.min, body.box.max, level.distance, options.cells, monitor, &result.report);
  result.error = level_surface_error(field, body.box.min, body.box.max, level.distance, options.cells, result.surface,
                                     result.report, monitor);
  const RawMesh& mesh = body.surface.mesh();
  result.surface.name = fmt::format("{} inflated by {:.6g}", mesh.name, level.distance);
  RawMesh found;
  found.vertices = result.surface.vertices;
  found.faces = result.surface.faces;
  result.audit = audit(found);
  if (!result.audit.closed || !result.audit.consistently_oriented)
    throw Error(Fault::check_failed, fmt::format("the level set {:.6g} came out with {} open edges: this is a fault of "
                                                 "the program",
                                                 level.distance, result.audit.open_edges));
  check_stop(monitor);
  if (outputs.any())
    result.output = outputs.write(level.key, result.surface,
                                  {fmt::format("level {:.17g}, distance from the surface", level.distance),
                                   "mesh " + mesh.name, "mesh_sha256 " + mesh.sha256},
                                  {"level", level.distance});
  return result;
}

void draw(const std::vector<Inflated>& bodies, const Options& options, Backend& backend, Monitor& monitor,
          AtomicFile& file) {
  std::vector<TriangleSurface> shown;
  for (const Inflated& body : bodies) shown.push_back(body.surface);
  const View view = parse_view(options.view);
  const Image image =
      backend.render(figures::scene_of(shown, std::span(&view, 1), {options.width, options.height, 0, false}), monitor);
  write_png(image, file);
  check_stop(monitor);
  file.commit();
}

void run(const Options& options, const Common& common) {
  std::vector<Level> levels = options.levels.empty() ? std::vector<Level>{} : parse_levels(options.levels);
  if (levels.empty() && (!options.output.empty() || !options.picture.empty())) levels = parse_levels(star_word);
  const bool wants_star = options.star || levels.empty() ||
                          std::any_of(levels.begin(), levels.end(), [](const Level& l) { return l.distance == 0; });
  const OriginChoice origin = parse_origin(options.origin);
  parse_view(options.view);
  if (!options.picture.empty() && (!options.picture.ends_with(".png") || options.picture.size() == 4))
    throw Error(Fault::bad_argument, fmt::format("--picture {}: the name must end in .png", options.picture));
  SurfaceOutputs outputs(options.output, options.format, levels.size(), "level");
  for (const Level& level : levels)
    if (outputs.any()) refuse_mesh_as_output(options.mesh, outputs.path(level.key));
  if (!options.picture.empty()) refuse_mesh_as_output(options.mesh, options.picture);
  if (outputs.any()) outputs.open(levels.front().key);
  std::unique_ptr<AtomicFile> picture;
  if (!options.picture.empty()) picture = std::make_unique<AtomicFile>(options.picture);

  const Body body = make_body(ClosedSurface::from(load_mended(options.mesh, options.mending)), origin, 1);
  ConsoleMonitor monitor(common.style());
  std::vector<std::string> notes = body_notes(body.surface, monitor, common.threads);
  std::string note;
  const auto backend = open_backend(common, &note);
  if (!note.empty()) {
    if (!common.quiet) say(fmt::format("cowgpu: {}\n", note));
    notes.push_back(note);
  }
  std::optional<StarShapeTime> star;
  double star_seconds = 0;
  if (wants_star) {
    const auto start = Clock::now();
    star = find_star_shape_time(body.surface.mesh(), body.origin, *backend, monitor);
    star_seconds = seconds_since(start);
  }
  const double longest = body.box.longest_side();
  for (Level& level : levels) {
    if (level.distance == 0) {
      if (star->lower == 0 && star->upper < 1e-4 * longest)
        throw Error(
            Fault::bad_argument,
            fmt::format(
                "--levels star: {} is star-shaped about ({:.6g}, {:.6g}, {:.6g}) as it is, or nearly, t* <= {:.3g}: "
                "there is nothing to show; name levels by numbers, or another --origin",
                body.surface.mesh().name, body.origin.x(), body.origin.y(), body.origin.z(), star->upper));
      level.distance = flow_time(0, *star);
    }
    if (!(level.distance >= 1e-4 * longest && level.distance <= 1e4 * longest))
      throw Error(
          Fault::bad_argument,
          fmt::format("a level of {:.6g} cannot be shown beside a body {:.6g} long: levels go from 1e-4 of that "
                      "to 1e4 times that",
                      level.distance, longest));
  }
  const auto field = backend->distance_field(body.surface.vertices(), body.surface.faces());
  // At most a quarter of the cubes is near the level, in thin bodies and for coarse lattices.
  const auto cubes = std::uint64_t(options.cells) * std::uint64_t(options.cells) * std::uint64_t(options.cells);
  MemoryNeed need = field->memory(cubes / 64 + 16 * std::uint64_t(options.cells) * std::uint64_t(options.cells));
  need.host += 600 * 6 * std::uint64_t(options.cells) * std::uint64_t(options.cells);
  if (!levels.empty()) check_memory(need, *backend, "lower --cells");
  std::vector<Inflated> bodies;
  for (const Level& level : levels) {
    bodies.push_back(inflate(level, options, body, *field, outputs, monitor));
    if (std::string coarse = coarse_note(bodies.back(), options.cells); !coarse.empty()) notes.push_back(coarse);
    monitor.clear();
    if (!bodies.back().output.empty() && !common.quiet) say(fmt::format("cowgpu: wrote {}\n", bodies.back().output));
  }
  if (picture) {
    const auto cpu = faster_drawing(*backend, common);
    draw(bodies, options, cpu ? *cpu : *backend, monitor, *picture);
    monitor.clear();
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.picture));
  }
  monitor.clear();
  write_report(options, common, body, backend->facts(), notes, star, star_seconds, bodies);
}

} // namespace

void add_inflate(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand(
      "inflate", "The body inflated by a distance, and by how much it must be to be star-shaped about a point");
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->capture_default_str();
  add_mend_options(*command, options->mending);
  command
      ->add_option("--levels", options->levels,
                   "Distances from the body, such as 0.05,0.1,star, where star is the least that makes it star-shaped")
      ->type_name("LIST");
  command->add_flag("--star", options->star,
                    "Find the least distance that makes it star-shaped about the origin, between bounds (without "
                    "--levels always)");
  command->add_option("--origin", options->origin, "com (centre of mass), mesh, or X,Y,Z in mesh coordinates")
      ->capture_default_str();
  command
      ->add_option("-o,--output", options->output,
                   "FILE.glb or FILE.ply, with {} for the level where there are several, or a folder, for "
                   "inflated-0.05.glb and the like")
      ->type_name("FILE|DIR");
  command->add_option("--format", options->format, "In a folder: glb (default) or ply")->check(one_of({"glb", "ply"}));
  command
      ->add_option("--cells", options->cells, "Cubes along the longest side of the box in which a level is looked for")
      ->check(in_range(4, 1024))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--picture", options->picture, "The inflated bodies side by side, FILE.png")->type_name("FILE");
  command->add_option("--view", options->view, "View of the picture: " + view_names() + ", or AZ,EL in degrees")
      ->type_name("VIEW")
      ->capture_default_str();
  command->add_option("--width", options->width, "Pixels of a panel of the picture")
      ->check(in_range(1, largest_picture))
      ->capture_default_str();
  command->add_option("--height", options->height, "Pixels of a panel of the picture")
      ->check(in_range(1, largest_picture))
      ->capture_default_str();
  command->add_flag("--json", options->json, "As JSON (data/schemas/cowgpu.inflate.v1.json)");
  add_common_options(*command, common);
  command->footer("Examples: cowgpu inflate benchmark --levels 0.05,0.1,0.2,star -o 'cow-{}.glb'\n"
                  "          cowgpu inflate benchmark --star --origin mesh");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
