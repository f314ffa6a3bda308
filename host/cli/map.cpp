#include "host/requests/map.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/expansion_words.hpp"
#include "host/cli/mend_options.hpp"
#include "host/io/document_json.hpp"
#include "host/requests/paper_recipe.hpp"

#include "host/error.hpp"
#include "host/io/map_file.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string mesh = "builtin:cow";
  Mending mending;
  std::string method; // empty: harmonic for a recipe, else stretch
  std::string weights = "cotangent", pole = "back", recipe;
  double disk_scale = 0;
  bool centre = false, polish = false, no_polish = false;
  unsigned sweeps = StretchOptions{}.sweeps;
  double lambda = 0;
  bool converge = false;
  unsigned relabellings = 0;
  int lmax = 512;
  std::string time = "auto", origin = "com";
  std::string output;
  bool json = false;
};

// An option and the method it belongs to.
struct Belonging {
  const Option* option;
  const char* method;
};

void refuse_strangers(const std::vector<Belonging>& belongings, const std::string& method) {
  for (const auto& [option, owner] : belongings)
    if (option->count() > 0 && method != owner)
      throw Error(Fault::bad_argument,
                  fmt::format("{} belongs to --method {}; the method is {}", option->get_name(), owner, method));
}

Pole parse_pole(const std::string& text) {
  Pole pole;
  if (text == "back") return pole;
  if (const auto vertex = read_natural(text)) {
    pole.vertex = *vertex;
    pole.rule = Pole::Rule::vertex;
    return pole;
  }
  const auto point = parse_point(text);
  if (!point)
    throw Error(
        Fault::bad_argument,
        fmt::format("--pole {}: it must be back, the number of a vertex (from 0) or three numbers X,Y,Z in mesh "
                    "coordinates",
                    text));
  pole.rule = Pole::Rule::point;
  pole.point = *point;
  return pole;
}

HarmonicOptions harmonic_options(const Options& options) {
  if (options.recipe == "paper") return paper::harmonic_map();
  HarmonicOptions harmonic;
  harmonic.weights = options.weights == "tutte"        ? EdgeWeights::tutte
                     : options.weights == "mean-value" ? EdgeWeights::mean_value
                                                       : EdgeWeights::cotangent;
  harmonic.pole = parse_pole(options.pole);
  harmonic.disk_scale = options.disk_scale;
  harmonic.centre = options.centre;
  if (options.polish || options.no_polish) harmonic.polish = options.polish;
  return harmonic;
}

StretchOptions stretch_options(const Options& options) {
  StretchOptions stretch;
  stretch.sweeps = options.sweeps;
  stretch.lambda = options.lambda;
  stretch.converge = options.converge;
  return stretch;
}

FlowMapOptions flow_options(const Options& options) {
  FlowMapOptions flow;
  if (const double time = parse_flow_time(options.time); time > 0) flow.time = time;
  flow.origin = parse_origin(options.origin);
  return flow;
}

MapRequest request_of(const Options& options) {
  MapRequest request;
  if (options.method == "harmonic")
    request.method = harmonic_options(options);
  else if (options.method == "smooth")
    request.method = SmoothOptions{};
  else if (options.method == "flow")
    request.method = flow_options(options);
  else
    request.method = stretch_options(options);
  request.relabellings = options.relabellings;
  request.lmax = options.lmax;
  return request;
}

void run(const Options& options, const Common& common) {
  MapRequest request = request_of(options);
  request.threads = common.threads;
  const MapFormat format = options.output.empty() ? MapFormat::ply : map_format(options.output);
  std::unique_ptr<AtomicFile> file; // before long work: what cannot be written should fail now
  if (!options.output.empty()) refuse_mesh_as_output(options.mesh, options.output);
  if (!options.output.empty()) file = std::make_unique<AtomicFile>(options.output);

  ConsoleMonitor monitor(common.style());
  request.mesh = load_mended(options.mesh, options.mending, monitor);
  // No Vulkan kernel makes maps: a device is opened only if it is asked for.
  if (common.device != "auto" && common.device != "cpu") {
    const auto backend = open_backend(common, nullptr);
    if (!common.quiet) say(fmt::format("cowgpu: maps are made on the CPU; {} is not used\n", backend->facts().name));
  }

  MapResult result = make_map(std::move(request), monitor);
  monitor.clear();
  if (file) {
    check_map(result);
    write_map(result.surface, result.map, format, *file);
    check_stop(monitor);
    file->commit();
    result.output = options.output;
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  }
  if (options.json)
    write_json(document(result, common.command), write_stdout);
  else
    write_screen(result, write_stdout);
}

} // namespace

void add_map(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand("map", "A map of a mesh of genus 0 to the sphere, and its quality");
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->capture_default_str();
  add_mend_options(*command, options->mending);
  command
      ->add_option(
          "--method", options->method,
          "stretch (the default: every part of the body keeps room on the sphere, and no triangle is flipped), "
          "harmonic or smooth (both keep angles, the better the finer the mesh, and shrink limbs to points), or flow "
          "(along the distance's gradient: may fold over itself)")
      ->check(one_of({"harmonic", "stretch", "smooth", "flow"}))
      ->type_name("NAME");
  Option* weights = command->add_option("--weights", options->weights, "harmonic: what an edge weighs")
                        ->check(one_of({"cotangent", "mean-value", "tutte"}))
                        ->capture_default_str();
  Option* pole = command
                     ->add_option("--pole", options->pole,
                                  "harmonic: the vertex taken out, by its number (from 0), as the nearest to "
                                  "X,Y,Z, or back (the middle of the top); the polished map is the same from all")
                     ->type_name("VERTEX|X,Y,Z|back")
                     ->capture_default_str();
  Option* scale =
      command
          ->add_option(
              "--disk-scale", options->disk_scale,
              "harmonic: the unit disk times S goes round the sphere, without polish (default: what brings half of the "
              "area to each hemisphere)")
          ->check(positive_number())
          ->type_name("S");
  Option* centre = command->add_flag("--centre", options->centre,
                                     "harmonic: only move the mean direction by area to the centre, without polish");
  Option* polish = command->add_flag("--polish", options->polish,
                                     "harmonic: go on until harmonic at the pole too, and fail where that cannot "
                                     "be done (default: do so, but where it cannot be done only centre)");
  Option* no_polish = command->add_flag("--no-polish", options->no_polish,
                                        "harmonic: stop at the disk's map; its boundary leaves shear round the "
                                        "pole, and the map depends on the pole");
  Option* recipe = command
                       ->add_option("--recipe", options->recipe,
                                    "harmonic: paper (the settings behind the published table of the cow)")
                       ->check(one_of({"paper"}))
                       ->type_name("NAME");
  scale->excludes(centre)->excludes(polish); // centring undoes any scale
  no_polish->excludes(polish);
  for (Option* own : {weights, pole, scale, centre, polish, no_polish}) recipe->excludes(own);
  Option* sweeps = command->add_option("--sweeps", options->sweeps, "stretch: relaxations of all vertices")
                       ->check(in_range(0U, most_sweeps))
                       ->type_name("N")
                       ->capture_default_str();
  Option* lambda = command
                       ->add_option("--lambda", options->lambda,
                                    "stretch: weight of the stretch from the body to the sphere; 0.1 makes the "
                                    "shear less extreme")
                       ->check(non_negative_number())
                       ->type_name("L")
                       ->capture_default_str();
  Option* converge =
      command->add_flag("--converge", options->converge, "stretch: go on to a minimum by Newton's method");
  Option* relabellings =
      command
          ->add_option("--relabellings", options->relabellings,
                       "stretch: map N copies of the body, numbered and turned at random, as well, and count those "
                       "that come to the same map (each takes as long as the first)")
          ->check(in_range(0U, most_relabellings))
          ->type_name("N")
          ->capture_default_str();
  Option* time = command
                     ->add_option("--time", options->time,
                                  "flow: for how long, in the mesh's length unit; auto: until the inflated body "
                                  "is star-shaped about the origin")
                     ->type_name("auto|T")
                     ->capture_default_str();
  Option* origin = command
                       ->add_option("--origin", options->origin,
                                    "flow: where directions are seen from: com (centre of mass), mesh or X,Y,Z")
                       ->capture_default_str();
  command->add_option("--lmax", options->lmax, "Degree of the grid that the map is judged against")
      ->check(in_range(1, largest_grid_degree))
      ->type_name("L")
      ->capture_default_str();
  command
      ->add_option("-o,--output", options->output,
                   "The positions on the sphere in the mesh's order: FILE.ply (doubles) or FILE.glb (for viewers)")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "As JSON (data/schemas/cowgpu.map.v1.json)");
  add_common_options(*command, common);
  command->footer("Examples: cowgpu map benchmark -o cow.ply; cowgpu map benchmark --recipe paper --lmax 256");
  const std::vector<Belonging> belongings = {
      {weights, "harmonic"},     {pole, "harmonic"},   {scale, "harmonic"}, {centre, "harmonic"}, {polish, "harmonic"},
      {no_polish, "harmonic"},   {recipe, "harmonic"}, {sweeps, "stretch"}, {lambda, "stretch"},  {converge, "stretch"},
      {relabellings, "stretch"}, {time, "flow"},       {origin, "flow"}};
  command->callback([options, &common, belongings] {
    if (options->method.empty()) options->method = options->recipe.empty() ? "stretch" : "harmonic";
    refuse_strangers(belongings, options->method);
    run(*options, common);
  });
}

} // namespace cowgpu::cli
