#include "host/cli/expansion_words.hpp"
#include "host/cli/order_list.hpp"
#include "host/cli/physics.hpp"

#include "host/error.hpp"
#include "host/io/csv_table.hpp"
#include "host/report/beside_paper.hpp"
#include "host/report/tip_plot.hpp"
#include "host/requests/tip.hpp"

#include <fmt/format.h>

namespace cowgpu::cli {
namespace {

using physics::Profile;

struct Options {
  std::vector<std::string> orders;
  std::string of, fields = "xyz", mesh;
  int lmax = -1, resolution = 0;
  std::string push, push_direction = "body", sustained = "500 N", punch = "5000 N", punch_duration;
  std::string side = "weaker";
  bool as_modelled = false;
  std::string tolerance;
  double gravity = physics::standard_gravity;
  double friction = -1; // below 0: not given
  bool smooth = false;
  std::string plot; // a picture of the boundary, or empty
};

double parse_between(const char* option, const std::string& text, const std::string& part, Dimension dimension,
                     const char* example) {
  const double value = parse_positive(option, part, dimension, example);
  const bool force = dimension == Dimension::force;
  const double least = force ? least_force : shortest_push, most = force ? largest_force : longest_push;
  if (value >= least && value <= most) return value;
  const char* unit = force ? "N" : "s";
  throw Error(Fault::bad_argument, fmt::format("{} {}: {} is out of range: {:g} {} to {:g} {}", option, text,
                                               force ? "the force" : "the duration", least, unit, most, unit));
}

Profile read_profile(const std::string& file) {
  const CsvTable table = read_csv(file);
  const auto named = [&](std::size_t column, const char* plain, const char* with_unit) {
    return table.columns[column] == plain || table.columns[column] == with_unit;
  };
  if (table.columns.size() != 2 || !named(0, "time", "time_s") || !named(1, "force", "force_N"))
    table.fail(Fault::file_syntax, table.header_line, "the columns of a push are time,force, in seconds and newtons");
  if (table.rows() < 2)
    table.fail(Fault::file_syntax, table.header_line, "a push over time is at least two rows of time and force");
  Profile profile;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double time = table.at(row, 0), force = table.at(row, 1);
    if (force < 0) table.fail_row(row, fmt::format("the force is {} N; it must not be below 0", force));
    if (force > largest_force)
      table.fail_row(row, fmt::format("the force is {} N; it must not be above {:g} N", force, largest_force));
    if (time > longest_push)
      table.fail_row(row, fmt::format("the time is {} s; a push must end within {:g} s", time, longest_push));
    if (time < (row ? profile.time.back() : 0))
      table.fail_row(row, fmt::format("the time is {} s, before what it follows; times rise from 0 on", time));
    profile.time.push_back(time);
    profile.force.push_back(force);
  }
  return profile;
}

Profile parse_push(const std::string& text) {
  if (text.ends_with(".csv")) return read_profile(text);
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos)
    throw Error(Fault::bad_argument, fmt::format("--push {}: it takes FORCE:DURATION, such as 5000N:0.1s, or a file, "
                                                 "which is known by its suffix .csv and holds the columns time,force "
                                                 "in seconds and newtons",
                                                 text));
  return physics::square_pulse(parse_between("--push", text, text.substr(0, colon), Dimension::force, "5000N:0.1s"),
                               parse_between("--push", text, text.substr(colon + 1), Dimension::time, "5000N:0.1s"));
}

PushRequest push_request(const Options& options) {
  PushRequest request;
  const auto option = [](const char* name, const std::string& text, Dimension dimension, const char* example) {
    return parse_between(name, text, text, dimension, example);
  };
  request.turns_with_body = options.push_direction == "body";
  request.sustained = option("--sustained", options.sustained, Dimension::force, "500N");
  request.punch = option("--punch", options.punch, Dimension::force, "5000N");
  if (!options.punch_duration.empty())
    request.punch_duration = option("--punch-duration", options.punch_duration, Dimension::time, "20ms");
  if (!options.push.empty()) request.profile = parse_push(options.push);
  request.profile_name = options.push;
  request.sustained_name = options.sustained;
  request.punch_name = options.punch;
  request.punch_duration_name = options.punch_duration;
  return request;
}

TipRequest request_of(const PhysicsCall& call, const Options& options) {
  TipRequest request;
  request.body = call.body;
  for (const int order : parse_orders(options.orders, "full"))
    if (order != whole_mesh) request.orders.push_back(order);
  request.of = options.of;
  request.fields = parse_fields(options.fields);
  request.mesh = options.mesh;
  request.lmax = options.lmax;
  request.resolution = options.resolution;
  if (options.side != "weaker") request.side = options.side == "left" ? physics::Side::left : physics::Side::right;
  request.smooth = options.smooth;
  request.as_modelled = options.as_modelled;
  if (!options.tolerance.empty())
    request.contact_tolerance = parse_measure("--contact-tolerance", options.tolerance, Dimension::length);
  request.gravity = options.gravity;
  if (options.friction >= 0) request.friction = options.friction;
  request.push = push_request(options);
  request.boundary = !options.plot.empty();
  return request;
}

physics::Findings solve(const PhysicsCall& call, const Options& options, const Common& program) {
  TipRequest request = request_of(call, options);
  if (!options.plot.empty()) {
    plot::picture_format(options.plot);
    for (const std::string& file : input_files(call.body)) refuse_mesh_as_output(file, options.plot);
  }
  std::string note;
  const auto backend = rebuilds_surfaces(request) ? open_backend(program, &note) : make_cpu_backend(program.threads);
  if (!note.empty()) request.notes.push_back(note);
  ConsoleMonitor monitor(program.style());
  const TipResult result = tip(request, *backend, monitor);
  monitor.clear();
  physics::Findings found = findings(result);
  if (call.paper) found.paper = beside_paper(result, monitor);
  if (!options.plot.empty()) {
    plot::write_plot(tip_plot(*result.push, monitor), options.plot);
    if (!program.quiet) say(fmt::format("cowgpu: wrote {}\n", options.plot));
  }
  return found;
}

void add_push_options(Command& command, Options& options) {
  command
      .add_option(
          "--push", options.push,
          "A push that lasts: a constant FORCE:DURATION, such as 5000N:0.1s, or FILE.csv (known by that suffix) "
          "with the columns time,force (s, N; straight lines between)")
      ->type_name("PUSH")
      ->check(not_empty());
  command
      .add_option("--push-direction", options.push_direction,
                  "body: at right angles to the line from pivot to point all the time; space: as it began")
      ->check(one_of({"body", "space"}))
      ->capture_default_str();
  command.add_option("--sustained", options.sustained, "A force that lasts, marked on the boundary")
      ->type_name("FORCE")
      ->capture_default_str();
  command
      .add_option("--punch", options.punch, "Force of a punch, of which the least duration that tips the body is found")
      ->type_name("FORCE")
      ->capture_default_str();
  command
      .add_option("--punch-duration", options.punch_duration,
                  "Duration of the punch, such as 20ms, and whether it tips the body then")
      ->type_name("TIME")
      ->check(not_empty());
}

} // namespace

Solve add_tip(Command& command, Common& common, BodyOptions&) {
  const auto options = std::make_shared<Options>();
  command.get_option("mesh")->description(
      "Coefficients of its surface (FILE of `cowgpu expand --of stretch`), or a mesh: " + mesh_help());
  command
      .add_option(
          "--order", options->orders,
          "Also the body of these orders of its surface, such as 0..8 or 0,4,full (the full body is always there)")
      ->type_name("LIST")
      ->allow_extra_args(false);
  command
      .add_option("--of", options->of,
                  "Map of a mesh: stretch (default), harmonic, smooth or flow; or name of the expansion of a file")
      ->type_name("NAME");
  command.add_option("--fields", options->fields, "xyz, or f: distance and angles about the origin")
      ->check(one_of({"xyz", "f"}))
      ->capture_default_str();
  command
      .add_option("--lmax", options->lmax,
                  "With --order: degree of a mesh's expansion (the largest order, 64 at least)")
      ->check(in_range(0, largest_surface_degree))
      ->type_name("L");
  command
      .add_option(
          "--resolution", options->resolution,
          "Vertices of rebuilt bodies lie on 2 N + 1 rings (N: four times the order, 128 at least, 256 at most or "
          "the order)")
      ->check(in_range(1, largest_grid_degree))
      ->type_name("N");
  command.add_option("--mesh", options->mesh, "The true body beside a file of coefficients")->type_name("MESH");
  command
      .add_option("--side", options->side,
                  "The side it falls to, about an axis along x (y is up): left (-z), right (+z), or the weaker")
      ->check(one_of({"weaker", "left", "right"}))
      ->capture_default_str();
  command.add_flag(
      "--smooth", options->smooth,
      "The mesh stands for a smooth surface, as orders do: where it touches at one point it rolls, and no facet "
      "holds it");
  command.add_flag("--as-modelled", options->as_modelled,
                   "Do not let it settle on a facet of its hull: the ground is the plane of least y");
  command
      .add_option(
          "--contact-tolerance", options->tolerance,
          "Height above the ground up to which vertices touch it, in the mesh's unit or with one (1e-9 of the body)")
      ->type_name("LENGTH")
      ->check(not_empty());
  command.add_option("--gravity", options->gravity, "Acceleration of gravity in m/s^2")
      ->check(positive_number())
      ->capture_default_str();
  command.add_option("--friction", options->friction, "Friction coefficient of the feet: do they slip first?")
      ->check(non_negative_number())
      ->type_name("MU");
  add_push_options(command, *options);
  command
      .add_option("--plot", options->plot,
                  "The boundary between tipping and falling back: least duration over force, FILE.png or FILE.svg")
      ->type_name("FILE")
      ->check(not_empty());
  add_common_options(command, common);
  return [options, &common](const PhysicsCall& call) { return solve(call, *options, common); };
}

} // namespace cowgpu::cli
