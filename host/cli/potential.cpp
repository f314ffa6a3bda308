#include "host/cli/order_list.hpp"
#include "host/cli/physics.hpp"
#include "host/cli/potential_places.hpp"

#include "host/error.hpp"
#include "host/number.hpp"
#include "host/report/beside_paper.hpp"
#include "host/report/potential_plot.hpp"
#include "host/requests/potential.hpp"

#include <fmt/format.h>

#include <sstream>

namespace cowgpu::cli {
namespace {

constexpr std::size_t most_shown = 20, most_in_json = 200; // points

struct Options {
  PlaceOptions places;
  int lmax = -1, derivatives = 2;
  bool exact = false, errors = false;
  std::string inside = "refuse", magnetisation, output, distances = "1,1.1,1.5,2,3,5,10";
  std::vector<std::string> plots;
  std::vector<std::string> orders = {"0,1,2,4,8,16,32"};
};

std::vector<double> parse_distances(const std::string& text) {
  std::vector<double> distances;
  std::istringstream words(text + ",");
  for (std::string word; std::getline(words, word, ',');) {
    const auto value = read_number(word);
    if (!value || !(*value >= 1) || !(*value <= physics::farthest_good))
      throw Error(Fault::bad_argument, fmt::format("--distances {}: \"{}\" is not a distance; distances are numbers "
                                                   "from 1 to {} between commas, in radii of "
                                                   "the sphere that holds the body",
                                                   text, word, physics::farthest_good));
    distances.push_back(*value);
  }
  return distances;
}

void check_options(const PhysicsCall& common, const Options& options) {
  const auto refuse = [](const std::string& why) { throw Error(Fault::bad_argument, why); };
  if (options.errors &&
      (options.places.any() || options.exact || !options.magnetisation.empty() || !options.output.empty()))
    refuse(
        "--errors has places of its own: leave --at, --sphere, --plane, --grid, --magnetisation, --exact and -o out");
  if (!options.errors && !options.plots.empty()) refuse("--plot draws the errors of --errors");
  if (options.output == "-") refuse("-o -: the standard output has the report; name a file");
  if (!options.output.empty()) file_format(options.output);
  for (const std::string& picture : options.plots) plot::picture_format(picture);
  std::vector<std::string> outputs = options.plots;
  if (!options.output.empty()) outputs.push_back(options.output);
  for (const std::string& output : outputs) {
    for (const std::string& name : input_files(common.body)) refuse_mesh_as_output(name, output);
    refuse_same_file(options.places.at, output);
  }
}

physics::Findings solve_errors(const PhysicsCall& call, const Options& options, const Common& common) {
  std::string note;
  const SeriesErrorsRequest request{call.body, parse_orders(options.orders), parse_distances(options.distances)};
  const auto backend = open_backend(common, &note);
  if (!common.quiet && !note.empty()) say(fmt::format("cowgpu: {}\n", note));
  ConsoleMonitor monitor(common.style());
  const SeriesErrorsResult result = series_errors(request, *backend, common.threads, monitor);
  for (const std::string& picture : options.plots)
    plot::write_plot(
        series_errors_plot(result.errors, fmt::format("How good the multipoles of {} are", result.subject.name)),
        picture);
  return findings(result);
}

physics::Findings solve(const PhysicsCall& call, const Options& options, const Common& common) {
  check_options(call, options);
  if (options.errors) return solve_errors(call, options, common);
  std::unique_ptr<AtomicFile> file;
  if (!options.output.empty()) file = std::make_unique<AtomicFile>(options.output);
  PotentialRequest request;
  request.body = call.body;
  request.places = parse_places(options.places);
  request.lmax = options.lmax;
  request.derivatives = Derivatives(options.derivatives);
  request.exact = options.exact;
  request.inside_exact = options.inside == "exact";
  if (!options.magnetisation.empty()) {
    request.magnetisation = parse_point(options.magnetisation);
    if (!request.magnetisation)
      throw Error(Fault::bad_argument,
                  fmt::format("--magnetisation {}: it takes X,Y,Z, three finite numbers in A/m, in the body's axes",
                              options.magnetisation));
  }
  if (file) request.extra_bytes = potential_file_bytes(count_places(request.places));
  // The closed form of few points is computed in 80-bit numbers, which no device has.
  std::string note;
  const auto backend = options.exact ? make_cpu_backend(common.threads) : open_backend(common, &note);
  if (options.exact && common.device != "auto" && common.device != "cpu")
    note = fmt::format("--device {} is not used: the closed form of the polyhedron is computed on the CPU, in 80-bit "
                       "arithmetic unless there are many points",
                       common.device);
  if (!note.empty()) request.notes.push_back(note);
  if (!common.quiet && !note.empty()) say(fmt::format("cowgpu: {}\n", note));
  ConsoleMonitor monitor(common.style());
  const PotentialResult result = potential(request, *backend, common.threads, monitor);
  monitor.clear();
  physics::Findings found = findings(result, call.json ? most_in_json : most_shown);
  if (call.paper) found.paper = potential_beside_paper();
  if (file) {
    write_potentials(potential_table(result), file_format(options.output), *file, monitor);
    check_stop(monitor);
    file->commit();
    if (!common.quiet) say(fmt::format("cowgpu: wrote {}\n", options.output));
  }
  return found;
}

} // namespace

Solve add_potential(Command& command, Common& common, BodyOptions& body) {
  const auto options = std::make_shared<Options>();
  command
      .add_option("--at", options->places.at,
                  "X,Y,Z in the body's coordinates, or a text file of points, one a line (- for standard input)")
      ->type_name("POINTS");
  command
      .add_option(
          "--sphere", options->places.sphere,
          "A sphere about the origin, of radius R: a length, or 1.5R for multiples of the sphere that holds the body "
          "(of the reference radius of a file that does not say it)")
      ->type_name("R");
  command.add_option("--resolution", options->places.resolution, "Rings of the Gauss-Legendre grid of --sphere")
      ->check(in_range(1, largest_grid_degree + 1))
      ->capture_default_str()
      ->type_name("N");
  command
      .add_option(
          "--plane", options->places.plane,
          "A plane AXIS,OFFSET,EXTENT,N: across x, y or z, OFFSET from the origin, EXTENT to all sides, N x N points")
      ->type_name("PLANE");
  command
      .add_option("--grid", options->places.grid,
                  "A lattice EXTENT,N in a cube about the origin: EXTENT to all six sides, N x N x N points")
      ->type_name("GRID");
  command
      .add_option("--order,--lmax", options->lmax, "Degree that the series goes to (default 32, of a file all it has)")
      ->check(in_range(0, largest_potential_degree))
      ->type_name("L");
  command
      .add_option("--derivatives", options->derivatives,
                  "0 potential, 1 acceleration too, 2 the acceleration's gradient too")
      ->check(in_range(0, 2))
      ->capture_default_str()
      ->type_name("N");
  command
      .add_option("--inside", options->inside,
                  "Points inside the sphere that holds the body: refuse, or exact, the polyhedron's closed form")
      ->check(one_of({"refuse", "exact"}))
      ->capture_default_str();
  command.add_flag("--exact", options->exact,
                   "The polyhedron's closed form everywhere, or where it is nearer to the truth (far away) its series");
  command.add_flag("--charge", body.charge, "--density is one of charge (C/m3): volts, and volts a metre");
  command
      .add_option("--magnetisation", options->magnetisation,
                  "The body is a magnet of so many A/m, X,Y,Z in its axes: its magnetic induction B in tesla too")
      ->type_name("X,Y,Z")
      ->check(not_empty());
  command.add_flag("--errors", options->errors,
                   "Instead of the field, relative errors of the series against the polyhedron, by distance and order");
  command.add_option("--orders", options->orders, "Orders of --errors, such as 0..4,8")
      ->capture_default_str()
      ->allow_extra_args(false)
      ->type_name("LIST");
  command
      .add_option("--distances", options->distances,
                  "Distances of --errors, in radii of the sphere that holds the body")
      ->capture_default_str()
      ->type_name("LIST");
  command.add_option("--plot", options->plots, "Picture of what --errors finds: FILE.png or FILE.svg; can be repeated")
      ->allow_extra_args(false)
      ->type_name("FILE");
  command.add_option("-o,--output", options->output, "Point by point: FILE.csv or FILE.nc")->type_name("FILE");
  add_common_options(command, common);
  return [options, &common](const PhysicsCall& call) { return solve(call, *options, common); };
}

} // namespace cowgpu::cli
