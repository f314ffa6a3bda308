#include "host/cli/commands.hpp"
#include "host/cli/drawing.hpp"
#include "host/cli/expansion_words.hpp"
#include "host/requests/expand_surfaces.hpp"

#include "host/error.hpp"
#include "host/figures/figures.hpp"
#include "host/io/mesh_source.hpp"
#include "host/physics/tip.hpp"
#include "host/requests/surface_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

namespace cowgpu::cli {
namespace {

struct Options {
  std::string name, mesh = "builtin:cow", output, of, recipe = "default", view = "28,14", plane = "yz";
  std::vector<std::string> results;
  int lmax = default_lmax;
  std::size_t lines = 240;
};

struct Figure {
  const char* name;
  const char* of;   ///< the maps it shows unless told otherwise; "": none
  bool lines_alone; ///< and so as SVG, too
};

constexpr Figure figures_known[] = {
    {"spectra", "all", true},        {"orders", "stretch", false}, {"components", "stretch", false},
    {"definition", "stretch", true}, {"inflation", "", false},     {"streamlines", "", true},
    {"tipping", "", false}};

// A mesh's name without its folder.
std::string short_name(const RawMesh& mesh) {
  return std::filesystem::path(mesh.name).filename();
}

std::string map_title(std::string_view map) {
  return map == name(MapMethod::flow) ? "gradient flow" : fmt::format("{} map", map);
}

/// What a figure is made from.
class Making {
public:
  Making(const Options& options, const Figure& figure, const Common& common)
      : options_(options), figure_(figure), backend_(open_backend(common, nullptr)), monitor_(common.style()),
        body_(make_body(ClosedSurface::from(load_mesh(options.mesh)), {}, 1)) {
    if (auto cpu = faster_drawing(*backend_, common)) backend_ = std::move(cpu);
  }

  plot::Canvas draw(plot::PictureFormat format) {
    const std::string name = figure_.name;
    const RawMesh& mesh = body_.surface.mesh();
    const View view = parse_view(options_.view);
    if (name == "inflation") return figures::inflation_figure(mesh, view, *backend_, monitor_);
    if (name == "streamlines")
      return figures::streamlines_figure(format, mesh, parse_plane(options_.plane), body_.origin, options_.lines,
                                         *backend_, monitor_);
    if (name == "tipping") return tipping();
    if (!options_.results.empty()) return of_results(format);
    const ExpansionChoice choice =
        parse_expansions(options_.of.empty() ? figure_.of : options_.of, options_.recipe, "", options_.lmax);
    const std::vector<SurfaceResult> results = expand(choice);
    if (name == "spectra") return spectra(format, choice, results);
    if (results.size() != 1 || choice.mass)
      throw Error(
          Fault::bad_argument,
          fmt::format("--of {}: the figure '{}' is of one map: harmonic, stretch, smooth or flow", options_.of, name));
    const SurfaceResult& result = results[0];
    const std::string title = fmt::format("{}, {}", short_name(mesh), map_title(cowgpu::name(result.of)));
    if (name == "orders")
      return figures::orders_figure(result.expansion, SurfaceFields::xyz, mesh, view, title, *backend_, monitor_);
    if (name == "components")
      return figures::components_figure(mesh, result.map, result.expansion.origin, view, title, *backend_, monitor_);
    return figures::definition_figure(format, mesh, result.map, result.expansion.origin);
  }

  ConsoleMonitor& monitor() { return monitor_; }

private:
  // Where all maps are shown because none was named, one that cannot be made is left out.
  std::vector<SurfaceResult> expand(const ExpansionChoice& choice) {
    std::vector<SurfaceResult> results;
    if (!options_.of.empty() || choice.maps.size() < 2) {
      results = expand_surfaces(choice, false, body_, *backend_, monitor_);
      check_surfaces(results);
      return results;
    }
    for (const MapMethod map : choice.maps) {
      ExpansionChoice one = choice;
      one.maps = {map};
      try {
        std::vector<SurfaceResult> of_map = expand_surfaces(one, false, body_, *backend_, monitor_);
        check_surfaces(of_map);
        results.push_back(std::move(of_map.front()));
      } catch (const Error& error) {
        if (error.fault() != Fault::map_failed && error.fault() != Fault::check_failed) throw;
        say(fmt::format("cowgpu: the {} is left out: {}\n", map_title(name(map)), error.what()));
      }
    }
    return results;
  }

  // Of expansions that are in files, with the mass of the mesh beside them.
  plot::Canvas of_results(plot::PictureFormat format) {
    std::vector<SurfaceSource> sources;
    for (const std::string& file : options_.results) {
      SurfaceChoice choice;
      choice.input = file;
      sources.push_back(load_surface(choice, 0, *backend_, monitor_));
      const std::string& hash = sources.back().mesh_hash;
      if (!hash.empty() && hash != body_.surface.mesh().sha256)
        throw Error(Fault::file_format,
                    fmt::format("--result {}: it is of {}, another mesh than {} by its SHA-256; name that "
                                "mesh, or expand this one",
                                file, sources.back().mesh, options_.mesh));
    }
    if (options_.name == std::string("orders"))
      return figures::orders_figure(
          sources[0].expansion, SurfaceFields::xyz, body_.surface.mesh(), parse_view(options_.view),
          fmt::format("{}, {}", short_name(body_.surface.mesh()), map_title(sources[0].name)), *backend_, monitor_);
    std::vector<figures::NamedExpansion> named;
    for (const SurfaceSource& source : sources) named.push_back({map_title(source.name), &source.expansion});
    const Multipoles mass = mass_moments();
    return figures::spectra_figure(format, named, &mass);
  }

  // A ball of the body's volume on the left, the body on the right.
  plot::Canvas tipping() {
    using namespace physics;
    const RigidBody cow = solid_body(body_);
    const Stance stance = stand(cow, {}), ball = stand(ball_like(cow, body_.mass()), {.as_modelled = true});
    const Tipping of_cow = physics::tipping(stance, Side::right), of_ball = physics::tipping(ball, Side::right);
    const std::array shown = {figures::TippedBody{&ball, &of_ball, "spherical body"},
                              figures::TippedBody{&stance, &of_cow, short_name(body_.surface.mesh())}};
    return figures::tipping_figure(shown, *backend_, monitor_);
  }

  Multipoles mass_moments() {
    MomentProblem problem;
    problem.vertices = body_.surface.vertices();
    problem.faces = body_.surface.faces();
    problem.origin = body_.origin;
    problem.reference_radius = body_.brillouin_radius;
    problem.lmax = options_.lmax;
    return backend_->moments(problem, monitor_);
  }

  plot::Canvas spectra(plot::PictureFormat format, const ExpansionChoice& choice,
                       const std::vector<SurfaceResult>& results) {
    std::vector<figures::NamedExpansion> named;
    for (const SurfaceResult& result : results) named.push_back({map_title(name(result.of)), &result.expansion});
    Multipoles mass;
    if (choice.mass) mass = mass_moments();
    return figures::spectra_figure(format, named, choice.mass ? &mass : nullptr);
  }

  const Options& options_;
  const Figure& figure_;
  std::unique_ptr<Backend> backend_;
  ConsoleMonitor monitor_;
  Body body_;
};

void run(const Options& options, const Common& common) {
  const Figure& figure = *std::find_if(std::begin(figures_known), std::end(figures_known),
                                       [&](const Figure& f) { return f.name == options.name; });
  const plot::PictureFormat format = plot::picture_format(options.output);
  if (format == plot::PictureFormat::svg && !figure.lines_alone)
    throw Error(Fault::bad_argument,
                fmt::format("-o {}: the figure '{}' shows surfaces, which are pixels: the name must "
                            "end in .png",
                            options.output, options.name));
  parse_view(options.view);
  parse_plane(options.plane);
  refuse_mesh_as_output(options.mesh, options.output);
  for (const std::string& file : options.results) refuse_same_file(file, options.output);
  const bool orders = options.name == "orders", takes_results = orders || options.name == "spectra";
  if (!options.results.empty() && (!takes_results || !options.of.empty() || (orders && options.results.size() > 1)))
    throw Error(Fault::bad_argument,
                "--result: the figures 'orders' (one file) and 'spectra' are made of results, and then "
                "--of says nothing");
  AtomicFile file(options.output);
  Making making(options, figure, common);
  plot::Canvas canvas = making.draw(format);
  making.monitor().clear();
  canvas.write(file);
  check_stop(making.monitor());
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
                   "tipping: a ball and the body, and what tips them")
      ->type_name("NAME")
      ->check(one_of(names))
      ->required();
  command->add_option("mesh", options->mesh, mesh_help())->type_name("MESH")->capture_default_str();
  command->add_option("-o,--output", options->output, "The page: FILE.png or, of lines alone, FILE.svg")
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
      ->check(in_range(8, largest_surface_degree))
      ->type_name("L")
      ->capture_default_str();
  command->add_option("--view", options->view, "View of surfaces: " + view_names() + ", or AZ,EL in degrees")
      ->type_name("VIEW")
      ->capture_default_str();
  command->add_option("--plane", options->plane, "Plane of streamlines: yz, xy or xz, or NX,NY,NZ,D")
      ->type_name("PLANE")
      ->capture_default_str();
  command->add_option("--count", options->lines, "Streamlines")
      ->check(in_range(std::size_t(1), std::size_t(100'000)))
      ->type_name("N")
      ->capture_default_str();
  add_common_options(*command, common);
  command->footer("Examples: cowgpu figure orders benchmark --of harmonic --recipe paper -o harmonic.png\n"
                  "          cowgpu figure spectra benchmark -o spectra.svg");
  command->callback([options, &common] { run(*options, common); });
}

} // namespace cowgpu::cli
