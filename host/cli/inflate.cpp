#include "host/requests/inflate.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/drawing.hpp"
#include "host/cli/mend_options.hpp"
#include "host/cli/surface_outputs.hpp"
#include "host/io/document_json.hpp"
#include "host/requests/render.hpp"

#include "host/error.hpp"
#include "host/io/png.hpp"
#include "host/io/shown.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

#include <algorithm>
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
  std::optional<double> distance; // nothing: the star-shape time
};

// Each once; a sentence about those that are named again goes to `notes`.
std::vector<Level> parse_levels(const std::string& text, std::vector<std::string>& notes) {
  std::vector<Level> levels;
  std::istringstream words(text + ",");
  for (std::string word; std::getline(words, word, ',');) {
    Level level{{word, "inflated-" + word}, {}};
    if (word != star_word) {
      level.distance = read_number(word).value_or(0);
      if (!(*level.distance > 0))
        throw Error(
            Fault::bad_argument,
            fmt::format("--levels {}: \"{}\" is not a level; levels are numbers above 0 in the mesh's length unit, "
                        "and star for the least that makes the body star-shaped, separated by commas",
                        shown(text), shown(word)));
    }
    const auto known =
        std::find_if(levels.begin(), levels.end(), [&](const Level& l) { return l.distance == level.distance; });
    if (known == levels.end())
      levels.push_back(level);
    else
      notes.push_back(fmt::format("--levels {}: {} is {} again, and one level", shown(text), word, known->key.text));
  }
  return levels;
}

void draw(const InflateResult& result, const Options& options, Backend& backend, Monitor& monitor, AtomicFile& file) {
  PictureRequest picture;
  for (const InflatedBody& body : result.bodies) picture.bodies.push_back(body.surface);
  picture.views = {parse_view(options.view)};
  picture.panels = {options.width, options.height, 0, false};
  write_png(draw_picture(picture, backend, monitor), file);
  check_stop(monitor);
  file.commit();
}

void run(const Options& options, const Common& common) {
  std::vector<std::string> notes;
  std::vector<Level> levels = options.levels.empty() ? std::vector<Level>{} : parse_levels(options.levels, notes);
  if (levels.empty() && (!options.output.empty() || !options.picture.empty())) levels = parse_levels(star_word, notes);
  InflateRequest request;
  request.origin = parse_origin(options.origin);
  request.star = options.star;
  request.cells = options.cells;
  request.threads = common.threads;
  for (const Level& level : levels) request.levels.push_back(level.distance);
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

  ConsoleMonitor monitor(common.style());
  request.mesh = load_mended(options.mesh, options.mending, monitor);
  std::string note;
  const auto backend = open_backend(common, &note);
  if (!common.quiet && !note.empty()) say(fmt::format("cowgpu: {}\n", note));
  const std::string name = request.mesh.name, sha256 = request.mesh.sha256;
  std::size_t number = 0;
  InflateResult result = inflate(std::move(request), *backend, monitor, [&](InflatedBody& body) {
    const OutputKey& key = levels[number++].key;
    body.name = key.text;
    if (outputs.any())
      body.output = outputs.write(key, body.surface,
                                  {fmt::format("level {:.17g}, distance from the surface", body.level), "mesh " + name,
                                   "mesh_sha256 " + sha256},
                                  {"level", body.level});
    monitor.clear();
    if (!body.output.empty() && !common.quiet) say(fmt::format("cowgpu: wrote {}\n", body.output));
  });
  result.notes.insert(result.notes.end(), notes.begin(), notes.end());
  if (!note.empty()) result.notes.push_back(note);
  if (picture) {
    const auto cpu = faster_drawing(*backend, common);
    draw(result, options, cpu ? *cpu : *backend, monitor, *picture);
    result.picture = options.picture;
    monitor.clear();
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.picture));
  }
  monitor.clear();
  if (options.json)
    write_json(document(result, common.command), write_stdout);
  else
    write_inflate(result, write_stdout);
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
      ->check(in_range(least_cells, most_cells))
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
