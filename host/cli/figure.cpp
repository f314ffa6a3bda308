#include "host/requests/figure.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/drawing.hpp"
#include "host/cli/expansion_words.hpp"
#include "host/requests/surface_source.hpp"

#include "host/error.hpp"
#include "host/io/mesh_source.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string name, mesh = "builtin:cow", output, of, recipe = "default", plane = "yz", values, colour;
  std::vector<std::string> results, views;
  int lmax = default_lmax;
  std::size_t lines = FigureRequest{}.streamlines;
};

struct Figure {
  const char* name;
  FigureKind kind;
  const char* of; ///< the maps it shows unless told otherwise; "": none
};

constexpr Figure figures_known[] = {{"spectra", FigureKind::spectra, "all"},
                                    {"orders", FigureKind::orders, "stretch"},
                                    {"components", FigureKind::components, "stretch"},
                                    {"definition", FigureKind::definition, "stretch"},
                                    {"inflation", FigureKind::inflation, ""},
                                    {"streamlines", FigureKind::streamlines, ""},
                                    {"tipping", FigureKind::tipping, ""},
                                    {"surface", FigureKind::surface, ""}};

FigureRequest request_of(const Options& options) {
  const Figure& figure = *std::find_if(std::begin(figures_known), std::end(figures_known),
                                       [&](const Figure& f) { return f.name == options.name; });
  FigureRequest request;
  request.kind = figure.kind;
  request.format = plot::picture_format(options.output);
  if (request.format == plot::PictureFormat::svg && !can_be_svg(figure.kind))
    throw Error(Fault::bad_argument,
                fmt::format("-o {}: the figure '{}' shows surfaces, which are pixels: the name must "
                            "end in .png",
                            options.output, options.name));
  const bool surface = figure.kind == FigureKind::surface;
  if (options.views.size() > 1 && !surface)
    throw Error(Fault::bad_argument, "--view: only the figure 'surface' is drawn from several sides; name one");
  for (const std::string& view : options.views) request.views.push_back(parse_view(view));
  if (!request.views.empty()) request.view = request.views.front();
  if (!surface && (!options.values.empty() || !options.colour.empty()))
    throw Error(Fault::bad_argument, "--values and --colour are about the figure 'surface'");
  request.values = options.values;
  request.colour = options.colour;
  request.plane = parse_plane(options.plane);
  request.streamlines = options.lines;
  request.results = options.results;
  const bool orders = options.name == "orders", takes_results = orders || options.name == "spectra";
  if (!options.results.empty() && (!takes_results || !options.of.empty() || (orders && options.results.size() > 1)))
    throw Error(Fault::bad_argument,
                "--result: the figures 'orders' (one file) and 'spectra' are made of results, and then "
                "--of says nothing");
  request.expansions.lmax = options.lmax;
  if (*figure.of && options.results.empty())
    request.expansions =
        parse_expansions(options.of.empty() ? figure.of : options.of, options.recipe, "", options.lmax);
  // Where all maps are shown because none was named, one that cannot be made is left out.
  request.leave_out = options.of.empty() && request.expansions.maps.size() > 1;
  return request;
}

void run(const Options& options, const Common& common) {
  FigureRequest request = request_of(options);
  refuse_mesh_as_output(options.mesh, options.output);
  for (const std::string& file : options.results) refuse_same_file(file, options.output);
  if (!options.values.empty()) refuse_same_file(options.values, options.output);
  AtomicFile file(options.output);
  auto backend = open_backend(common, nullptr);
  ConsoleMonitor monitor(common.style());
  if (request.kind == FigureKind::surface && request.values.empty()) {
    if (options.mesh == "-")
      throw Error(Fault::bad_argument, "-: the figure 'surface' needs --values of a mesh from standard input");
    request.mesh_name = options.mesh;
    request.threads = common.threads;
  } else
    request.mesh = load_mesh(options.mesh);
  if (auto cpu = faster_drawing(*backend, common)) backend = std::move(cpu);
  FigureResult result = make_figure(std::move(request), *backend, monitor);
  monitor.clear();
  for (const std::string& sentence : result.left_out) say(fmt::format("cowgpu: {}\n", sentence));
  result.page.write(file);
  check_stop(monitor);
  file.commit();
  if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
}

} // namespace

void add_figure(Command& app, Common& common) {
  const auto options = std::make_shared<Options>();
  Command* command = app.add_subcommand("figure", "One of the paper's figures, or one it lacks, of any body");
  std::vector<std::string> names;
  for (const Figure& figure : figures_known) names.emplace_back(figure.name);
  command
      ->add_option("name", options->name,
                   "spectra: power by degree. orders: orders 0 to 7 and the body. components: f on the body and on the "
                   "sphere. definition: what f is. inflation: level sets of the distance. streamlines: of its flow. "
                   "tipping: a ball and the body, and what tips them. surface: a quantity on the body, in colours")
      ->type_name("NAME")
      ->check(one_of(names))
      ->required();
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->capture_default_str();
  command->add_option("-o,--output", options->output, "The page: FILE.png or, of lines alone and of surface, FILE.svg")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("--of", options->of,
                   "The map (stretch): harmonic, stretch, smooth or flow; for spectra a list, mass among it (all)")
      ->type_name("NAME");
  command
      ->add_option("--result", options->results,
                   "Result file (FILE.json) of the mesh, whose expansions orders and spectra take; can be repeated")
      ->allow_extra_args(false)
      ->type_name("FILE");
  command->add_option("--recipe", options->recipe, "paper: harmonic map and flow as the paper made them")
      ->check(one_of({"default", "paper"}))
      ->capture_default_str();
  command->add_option("--lmax", options->lmax, "Degree of the expansions")
      ->check(in_range(least_figure_degree, largest_surface_degree))
      ->type_name("L")
      ->capture_default_str();
  command
      ->add_option("--view", options->views,
                   "View of surfaces: " + view_names() +
                       ", or AZ,EL in degrees (28,14); of surface can be repeated (four sides)")
      ->allow_extra_args(false)
      ->type_name("VIEW");
  command
      ->add_option("--values", options->values,
                   "Of surface: FILE.csv of `cowgpu surface MESH`, values at faces or vertices (of the body of density "
                   "1 that does "
                   "not spin)")
      ->type_name("FILE");
  command->add_option("--colour", options->colour, "Of surface: the quantity, by its column (slope)")
      ->type_name("NAME");
  command->add_option("--plane", options->plane, "Plane of streamlines: yz, xy or xz, or NX,NY,NZ,D")
      ->type_name("PLANE")
      ->capture_default_str();
  command->add_option("--count", options->lines, "Streamlines")
      ->check(in_range(std::size_t(1), most_figure_lines))
      ->type_name("N")
      ->capture_default_str();
  add_common_options(*command, common);
  command->footer("Examples: cowgpu figure orders benchmark --of harmonic --recipe paper -o harmonic.png\n"
                  "          cowgpu figure spectra benchmark -o spectra.svg\n"
                  "          cowgpu surface builtin:asteroid --period 4 -o asteroid.csv\n"
                  "          cowgpu figure surface builtin:asteroid --values asteroid.csv --colour slope -o slope.png");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
