#include "host/cli/tip_input.hpp"
#include "host/cli/tip_plot.hpp"
#include "host/cli/tip_push.hpp"

#include "host/error.hpp"
#include "host/io/mesh_source.hpp"
#include "host/physics/paper.hpp"
#include "host/spectrum/expand_surface.hpp"
#include "host/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::cli {
namespace {

using namespace physics;

constexpr double degrees = 180 / std::numbers::pi;
constexpr double least_gravity = 1e-6, largest_gravity = 1e13; // m/s^2
constexpr double least_weight = 1e-30, largest_weight = 1e40;  // N

struct Options {
  TipChoice choice;
  PushOptions push;
  std::string side = "weaker";
  bool as_modelled = false;
  std::string tolerance;
  double gravity = standard_gravity;
  double friction = -1; // below 0: not given
  bool smooth = false;
  std::string plot; // a picture of the boundary, or empty
};

// A body on the ground and what tips it to either side.
struct Stood {
  Stance stance;
  Tipping left, right;
  Side side = Side::right;
  const Tipping& chosen() const { return side == Side::left ? left : right; }
};

Stood stand_up(RigidBody body, const StandOptions& how, const std::string& side, const Monitor& monitor) {
  Stood stood;
  stood.stance = stand(std::move(body), how, monitor);
  stood.left = tipping(stood.stance, Side::left);
  stood.right = tipping(stood.stance, Side::right);
  stood.side = side == "left" ? Side::left : side == "right" ? Side::right : weaker_side(stood.left, stood.right);
  return stood;
}

StandOptions stand_options(const Options& options, const TipInput& input) {
  StandOptions how;
  how.as_modelled = options.as_modelled;
  if (options.tolerance.empty()) return how;
  const Measure tolerance = parse_measure("--contact-tolerance", options.tolerance, Dimension::length);
  if (!(tolerance.value >= 0))
    throw Error(Fault::bad_argument, fmt::format("--contact-tolerance {}: it must not be below 0", options.tolerance));
  if (tolerance.has_unit && !input.full.units.stated)
    throw Error(Fault::bad_argument, fmt::format("--contact-tolerance {}: a length with a unit needs the mesh's: add "
                                                 "--length-unit or --length",
                                                 options.tolerance));
  how.contact_tolerance = tolerance.value * (tolerance.has_unit ? 1 : input.full.units.metre);
  return how;
}

// Forces in newtons, where there are any.
struct Weight {
  double newtons = 0;
  bool metric = false;
  Value of(double force) const { return metric ? Value(force * newtons) : Value(); }
  Value of(const std::optional<double>& force) const { return force ? of(*force) : Value(); }
};

std::vector<Value> order_row(const Value& order, const Stood& s, double gravity, bool metric, const std::string& note) {
  const Tipping& t = s.chosen();
  const Weight weight{s.stance.body.mass * gravity, metric};
  const Rocker body = rocker(s.stance.body, t, gravity, true);
  return {order,
          name(t.side),
          t.pivot,
          t.point,
          t.direction,
          weight.of(t.force),
          t.force,
          weight.of(t.force_paper_balance),
          t.force_paper_balance,
          weight.of(s.left.force),
          weight.of(s.right.force),
          t.friction_needed,
          metric ? Value(body.least_impulse()) : Value(),
          metric ? Value(body.inertia) : Value(),
          s.stance.attitude.angle * degrees,
          note};
}

std::string order_note(const Stood& stood, const std::string& first) {
  std::string note = first;
  const auto add = [&](const char* text) { note += (note.empty() ? "" : "; ") + std::string(text); };
  if (stood.chosen().rolls) add("rolls over the point that it touches at");
  if (stood.stance.held) add("held fore and aft");
  return note;
}

Table orders_table(const TipInput& input, const Options& options, const StandOptions& how, const Stood& full,
                   const std::string& length, Monitor& monitor) {
  Table table{"orders",
              fmt::format("by order{}: the force that begins to tip it, and to which side",
                          input.expansion ? " of " + input.expansion_name : ""),
              {{"order"},
               {"side"},
               {"pivot", length, false},
               {"point", length, false},
               {"direction", "", false},
               {"force_N", "N"},
               {"force_over_weight"},
               {"force_N_paper_balance", "N"},
               {"force_over_weight_paper_balance", "", false},
               {"force_left_N", "N", false},
               {"force_right_N", "N", false},
               {"friction_needed"},
               {"least_impulse_Ns", "N s"},
               {"inertia_about_pivot", "kg m^2", false},
               {"settle_angle_deg", "degrees"},
               {"note"}},
              {}};
  table.as_entries = true;
  for (std::size_t i = 0; i < input.orders.size(); ++i) {
    check_stop(monitor);
    monitor.progress("orders stood up", double(i) / double(input.orders.size()));
    const int order = input.orders[i];
    StandOptions standing = how;
    if (order == 0) standing.as_modelled = true; // a ball stands in any attitude, but on facets of its triangulation
    try {
      std::string note;
      RigidBody body = order_body(input, options.choice, order, monitor, note);
      const Stood stood = stand_up(std::move(body), standing, options.side, monitor);
      table.rows.push_back(
          order_row(double(order), stood, options.gravity, input.full.units.stated, order_note(stood, note)));
    } catch (const Error& error) {
      if (error.fault() != Fault::cannot_stand && error.fault() != Fault::mesh_no_volume &&
          error.fault() != Fault::mesh_not_finite)
        throw;
      std::vector<Value> row(table.columns.size());
      row.front() = double(order);
      const std::string reason = error.what();
      row.back() = reason.substr(0, reason.find(';')); // without the advice
      table.rows.push_back(std::move(row));
    }
  }
  table.rows.push_back(order_row(std::string("full"), full, options.gravity, input.full.units.stated,
                                 order_note(full, input.full_is == "the mesh" ? "" : input.full_is)));
  return table;
}

// A roll after the other; on fine bodies there are many.
Table rolls_table(const Attitude& attitude, const std::string& length) {
  Table table{"rolls",
              "how it rolled to rest",
              {{"over"},
               {"vertex", "", false},
               {"second_vertex", "", false},
               {"angle_deg", "degrees"},
               {"barycentre_height_before", length},
               {"barycentre_height_after", length}},
              {}};
  for (const physics::Roll& roll : attitude.rolls) {
    const bool edge = roll.over.size() == 2;
    table.rows.push_back({std::string(edge ? "edge" : "corner"), double(roll.over[0]),
                          edge ? Value(double(roll.over[1])) : Value(), roll.angle * degrees, roll.before, roll.after});
  }
  return table;
}

Table patch_table(const Stance& stance, const std::string& length) {
  Table table{"contact_patch", "corners of the contact patch", {{"x", length}, {"y", length}, {"z", length}}, {}};
  for (const Vec3& p : stance.contact.patch) table.rows.push_back({p.x(), p.y(), p.z()});
  return table;
}

void add_force_rows(const Stood& stood, const TipInput& input, const Options& options, Findings& found) {
  const Stance& stance = stood.stance;
  const Tipping& t = stood.chosen();
  const std::string length = input.full.units.stated ? "m" : "mesh units";
  const Weight weight{stance.body.mass * options.gravity, input.full.units.stated};
  found.rows = {
      {"body", "body", input.full_is},
      {"attitude", "attitude", std::string(options.as_modelled ? "as modelled" : "settled")},
      {"settle_angle_deg", "angle turned to settle", stance.attitude.angle * degrees, "degrees"},
      {"settle_rolls", "rolls until it rests", double(stance.attitude.rolls.size())},
      {"support_points", "vertices that touch the ground", double(stance.contact.support.size())},
      {"over_patch", "barycentre over the contact patch", !stance.held},
      {"mass_kg", "mass", input.full.units.stated ? Value(stance.body.mass) : Value(), "kg"},
      {"gravity", "gravity", options.gravity, "m/s^2"},
      {"weight_N", "weight", weight.of(1), "N"},
      {"barycentre", "barycentre", stance.body.centre, length},
      {"side", "side that it falls to", name(t.side)},
      {"pivot", "pivot", t.pivot, length},
      {"point", "point of the push", t.point, length},
      {"direction", "direction of the push", t.direction},
      {"force_N", "force to begin, about the pivot", weight.of(t.force), "N"},
      {"force_over_weight", "force to begin over the weight", t.force},
      {"force_over_weight_paper_balance", "paper's balance: force over the weight", t.force_paper_balance},
      {"force_N_paper_balance", "paper's balance, about the barycentre", weight.of(t.force_paper_balance), "N"},
      {"force_N_paper_literal", "paper's balance, its arm in space", weight.of(t.force_paper_literal), "N",
       input.full.units.stated ? "none: its ray meets no surface" : "not known"},
      {"force_left_N", "force to begin, to the left", weight.of(stood.left.force), "N"},
      {"force_right_N", "force to begin, to the right", weight.of(stood.right.force), "N"},
      {"friction_needed", "friction coefficient not to slip", t.friction_needed},
  };
  if (options.friction < 0) return;
  const double slip = t.slip_force(options.friction);
  found.rows.push_back({"friction", "friction coefficient", options.friction});
  found.rows.push_back({"slip_force_N", "force that makes it slip", weight.of(slip), "N"});
  found.rows.push_back({"slip_force_over_weight", "slip force over the weight", slip});
  found.rows.push_back({"slips_before_tipping", "slips before it tips", options.friction < t.friction_needed});
}

// Whether the patch is less than a twentieth of the barycentre's height across.
bool narrow(const Stance& stance) {
  double across = 0;
  for (const Vec3& p : stance.contact.patch) across = std::max(across, (p - stance.contact.patch.front()).norm());
  return across < 0.05 * (stance.body.centre.y() - stance.contact.ground);
}

std::string counted(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string settled_note(const Attitude& attitude) {
  const auto& rolls = attitude.rolls;
  const auto corners = std::size_t(
      std::count_if(rolls.begin(), rolls.end(), [](const physics::Roll& roll) { return roll.over.size() == 1; }));
  return fmt::format(
      "settled: from the attitude as modelled it rolled over {} and {} of its hull, each time the one nearest to the "
      "point below its barycentre, until that was over a facet; coordinates are those of the body turned by all these "
      "rolls, {:.6g} degrees about their origin{}",
      counted(corners, "corner"), counted(rolls.size() - corners, "edge"), attitude.angle * degrees,
      std::abs(attitude.heading) > 1e-9
          ? fmt::format(" (the least turn to the same facet, by {:.6g} degrees, has a heading {:.4g} degrees away)",
                        attitude.least_angle * degrees, std::abs(attitude.heading) * degrees)
          : "");
}

void add_notes(const Stood& stood, const TipInput& input, const Options& options, Findings& found) {
  const Stance& stance = stood.stance;
  if (!input.full.units.stated)
    found.notes.push_back("no unit of length was stated: forces are in units of the body's weight; --length or "
                          "--length-unit, with --density, make them newtons");
  if (!options.as_modelled && stance.attitude.angle == 0)
    found.notes.push_back("settled: it stands as modelled, its barycentre over a facet of its hull");
  else if (!options.as_modelled)
    found.notes.push_back(settled_note(stance.attitude));
  if (stance.attitude.balanced)
    found.notes.push_back(
        "on the way it stood on a corner or an edge in balance; it was made to fall to the right, or off the "
        "edge");
  if (stance.held)
    found.notes.push_back(
        "the barycentre is not over the contact patch: unless it is held it falls fore or aft first; only "
        "torque about x counts here");
  if (stood.chosen().rolls)
    found.notes.push_back(
        "the body is smooth and touches the ground right under its barycentre: it rolls over that point");
  if (!stance.body.smooth && narrow(stance))
    found.notes.push_back(
        "the contact patch is no wider than a few triangles: if they stand for a smooth surface, --smooth "
        "lets it roll over the point where it touches");
  if (!input.orders.empty())
    found.notes.push_back("orders have the mass of the whole; where their surface crosses itself, regions count by how "
                          "often it winds round them; an order that cannot stand has no force");
  found.notes.push_back(
      "the force acts at the last point of the ray from the pivot through the barycentre, at right angles "
      "to it; the paper's balance about the barycentre leaves out friction's torque");
}

std::vector<Comparison> beside_paper(const TipInput& input, const Options& options, const Stood& settled,
                                     const Monitor& monitor) {
  const double weight = settled.stance.body.mass * options.gravity;
  constexpr double human = paper::sustained_force_N;
  const auto factor = [&](double force) {
    return fmt::format("no force is printed: 500 N are 'out of reach by a factor of a few', here {:.2f}",
                       force / human);
  };
  std::vector<Comparison> rows;
  const double volume = cowgpu::volume(input.full.vertices, input.full.faces);
  const Stood ball = stand_up(ball_like(input.full, volume), {}, "right", monitor);
  rows.push_back({"spherical cow, N", ball.chosen().force * weight, 0});
  const auto add = [&](const std::string& what, double force) { rows.push_back({what, force, human, factor(force)}); };
  const Tipping& t = settled.chosen();
  add("settled, N", t.force * weight);
  add("settled, its balance, N", t.force_paper_balance * weight);
  if (t.force_paper_literal) add("settled, its arm in space, N", *t.force_paper_literal * weight);
  if (input.head.sha256 != benchmark_sha256) return rows;
  for (const auto& [what, tolerance] :
       {std::pair("hind hooves' tips", 0.0), std::pair("hind hooves", 0.005), std::pair("all hooves", 0.01)}) {
    const Stood modelled = stand_up(input.full, {true, tolerance * input.full.units.metre}, "weaker", monitor);
    add(fmt::format("as modelled, {}, N", what), modelled.chosen().force * weight);
  }
  return rows;
}

void check_gravity(double gravity) {
  if (!(gravity >= least_gravity && gravity <= largest_gravity))
    throw Error(
        Fault::bad_argument,
        fmt::format("--gravity {}: it must be from {:g} m/s^2 to {:g} m/s^2, as it is from the smallest asteroids to "
                    "neutron stars",
                    gravity, least_gravity, largest_gravity));
}

void check_weight(const TipInput& input, double gravity) {
  const double weight = input.full.mass * gravity;
  if (input.full.units.stated && !(weight >= least_weight && weight <= largest_weight))
    throw Error(Fault::bad_argument,
                fmt::format("the body weighs {:.3g} N: a push can be followed from {:g} N to {:g} N; look at --length, "
                            "--length-unit and --density",
                            weight, least_weight, largest_weight));
}

Findings solve(const PhysicsCall& common, const Options& options, const Common& program) {
  check_gravity(options.gravity);
  const PushPlan plan = plan_push(options.push);
  if (!options.plot.empty()) {
    check_tip_plot(options.plot);
    for (const std::string& file : input_files(common.body)) refuse_mesh_as_output(file, options.plot);
  }
  TipInput input = load_tip_input(common.body, options.choice, program);
  if (!input.full.units.stated && (plan.profile || plan.punch_duration || !options.plot.empty()))
    throw Error(Fault::bad_argument,
                "--push, --punch-duration and --plot are about newtons and seconds: add --length, how long "
                "the body is, or --length-unit, and its --density");
  check_weight(input, options.gravity);
  const StandOptions how = stand_options(options, input);
  input.full.smooth = input.full.smooth || options.smooth;
  ConsoleMonitor monitor(program.style());
  const Stood stood = stand_up(input.full, how, options.side, monitor);
  Findings found(input.head);
  add_notes(stood, input, options, found);
  add_force_rows(stood, input, options, found);
  const std::string length = input.full.units.stated ? "m" : "mesh units";
  std::optional<double> friction;
  if (options.friction >= 0) friction = options.friction;
  const Rocker body = rocker(stood.stance.body, stood.chosen(), options.gravity, plan.turns_with_body);
  if (input.full.units.stated) add_push_findings(body, options.push, plan, friction, monitor, found);
  if (!options.plot.empty() && !(body.balance > 0))
    throw Error(Fault::bad_argument, "--plot: any push tips this body, so there is no boundary to draw");
  found.tables.insert(found.tables.begin(), patch_table(stood.stance, length));
  if (!stood.stance.attitude.rolls.empty())
    found.tables.insert(found.tables.begin(), rolls_table(stood.stance.attitude, length));
  found.tables.push_back(orders_table(input, options, how, stood, length, monitor));
  monitor.clear();
  if (common.paper) {
    const Stood settled = options.as_modelled ? stand_up(input.full, {}, options.side, monitor) : stood;
    found.paper = beside_paper(input, options, settled, monitor);
  }
  if (!options.plot.empty()) {
    check_stop(monitor);
    write_tip_plot(body, options.push, plan, monitor, options.plot);
    if (!program.quiet) say(fmt::format("cowgpu: wrote {}\n", options.plot));
  }
  return found;
}

} // namespace

Solve add_tip(Command& command, Common& common, BodyOptions&) {
  const auto options = std::make_shared<Options>();
  command.get_option("mesh")->description(
      "Coefficients of its surface (FILE of `cowgpu expand --of stretch`), or a mesh: " + mesh_help());
  command
      .add_option(
          "--order", options->choice.orders,
          "Also the body of these orders of its surface, such as 0..8 or 0,4,full (the full body is always there)")
      ->type_name("LIST")
      ->allow_extra_args(false);
  command
      .add_option("--of", options->choice.of,
                  "Map of a mesh: stretch (default), harmonic, smooth or flow; or name of the expansion of a file")
      ->type_name("NAME");
  command.add_option("--fields", options->choice.fields, "xyz, or f: distance and angles about the origin")
      ->check(one_of({"xyz", "f"}))
      ->capture_default_str();
  command
      .add_option("--lmax", options->choice.lmax,
                  "With --order: degree of a mesh's expansion (the largest order, 64 at least)")
      ->check(in_range(0, largest_surface_degree))
      ->type_name("L");
  command
      .add_option(
          "--resolution", options->choice.resolution,
          "Vertices of rebuilt bodies lie on 2 N + 1 rings (N: four times the order, 128 at least, 256 at most or "
          "the order)")
      ->check(in_range(1, largest_grid_degree))
      ->type_name("N");
  command.add_option("--mesh", options->choice.mesh, "The true body beside a file of coefficients")->type_name("MESH");
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
  add_push_options(command, options->push);
  command
      .add_option("--plot", options->plot,
                  "The boundary between tipping and falling back: least duration over force, FILE.png or FILE.svg")
      ->type_name("FILE")
      ->check(not_empty());
  add_common_options(command, common);
  return [options, &common](const PhysicsCall& call) { return solve(call, *options, common); };
}

} // namespace cowgpu::cli
