#include "host/cli/tip_push.hpp"

#include "host/cli/commands.hpp"
#include "host/cli/quantities.hpp"
#include "host/error.hpp"
#include "host/io/csv_table.hpp"
#include "host/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::cli {
namespace {

using namespace physics;

constexpr double degrees = 180 / std::numbers::pi;

constexpr double least_force = 1e-30, largest_force = 1e30; // N
constexpr double shortest_push = 1e-15, longest_push = 1e9; // s

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
  return square_pulse(parse_between("--push", text, text.substr(0, colon), Dimension::force, "5000N:0.1s"),
                      parse_between("--push", text, text.substr(colon + 1), Dimension::time, "5000N:0.1s"));
}

Value finite(double value) {
  return std::isfinite(value) ? Value(value) : Value();
}

std::string name(Outcome outcome) {
  if (outcome == Outcome::tipped) return "tips over";
  return outcome == Outcome::fell_back ? "lifts off and falls back" : "never lifts off";
}

Table boundary(const Rocker& rocker, const PushOptions& options, const PushPlan& plan,
               const std::optional<double>& friction, const Monitor& monitor) {
  struct Row {
    double force;
    std::string mark;
  };
  const double threshold = rocker.threshold();
  std::vector<Row> forces = {{plan.sustained, options.sustained + " sustained"},
                             {plan.punch, options.punch + " punch"},
                             {threshold, "threshold"}};
  for (const double factor : {1.001, 1.01, 1.03, 1.1, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0, 50.0, 100.0})
    forces.push_back({factor * threshold, ""});
  std::stable_sort(forces.begin(), forces.end(), [](const Row& a, const Row& b) { return a.force < b.force; });
  Table table{"boundary",
              "how long a constant push must last to tip it, its feet held where they are (-: it never does)",
              {{"force_N", "N"}, {"least_duration_s", "s"}, {"impulse_Ns", "N s"}, {"friction_needed"}, {"mark"}},
              {}};
  if (friction) table.columns.insert(table.columns.end() - 1, {"grips"});
  for (const Row& row : forces) {
    const double duration = rocker.least_duration(row.force, monitor);
    const bool tips = std::isfinite(duration);
    const Profile pulse = square_pulse(row.force, tips ? duration * (1 + 1e-9) : 1);
    const double needed = push(rocker, pulse, monitor).friction_needed;
    std::vector<Value> values = {row.force, finite(duration), finite(duration * row.force), finite(needed)};
    if (friction) values.emplace_back(needed <= *friction);
    values.emplace_back(row.mark);
    table.rows.push_back(std::move(values));
  }
  return table;
}

void add_profile(const Rocker& rocker, const PushOptions& options, const Profile& profile,
                 const std::optional<double>& friction, const Monitor& monitor, Findings& found) {
  const PushResult result = push(rocker, profile, monitor);
  const bool lifted = result.outcome != Outcome::never_lifted;
  const std::vector<Finding> rows = {
      {"push", "push", options.push},
      {"push_impulse_Ns", "impulse of the push", profile.impulse(), "N s"},
      {"push_outcome", "outcome of the push", name(result.outcome)},
      {"push_tips", "push tips it over", result.outcome == Outcome::tipped},
      {"push_peak_tilt_deg", "largest tilt under the push", result.peak_tilt * degrees, "degrees"},
      {"push_lift_time_s", "time until it lifts off", lifted ? Value(result.lift_time) : Value(), "s", "never"},
      {"push_end_time_s", "time until past the balance, or landed", lifted ? finite(result.end_time) : Value(), "s",
       lifted ? "not known" : "never"},
      {"push_friction_needed", "friction coefficient for the push", finite(result.friction_needed), "",
       "none is enough: the feet leave the ground"},
  };
  found.rows.insert(found.rows.end(), rows.begin(), rows.end());
  if (std::isinf(result.friction_needed))
    found.notes.push_back(
        fmt::format("after {:.4g} s of the push the feet leave the ground: the body does not turn about "
                    "their edge any longer",
                    result.friction_time));
  if (!friction) return;
  const bool slips = result.friction_needed > *friction;
  found.rows.push_back({"push_slips", "feet slip under the push", slips});
  if (slips)
    found.notes.push_back(fmt::format("the feet slip during the push (first or most at {:.4g} s): the tilt is that of "
                                      "feet that are held",
                                      result.friction_time));
}

} // namespace

void add_push_options(Command& command, PushOptions& options) {
  command
      .add_option(
          "--push", options.push,
          "A push that lasts: a constant FORCE:DURATION, such as 5000N:0.1s, or FILE.csv (known by that suffix) "
          "with the columns time,force (s, N; straight lines between)")
      ->type_name("PUSH")
      ->check(not_empty());
  command
      .add_option("--push-direction", options.direction,
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

PushPlan plan_push(const PushOptions& options) {
  PushPlan plan;
  plan.turns_with_body = options.direction == "body";
  const auto option = [](const char* name, const std::string& text, Dimension dimension, const char* example) {
    return parse_between(name, text, text, dimension, example);
  };
  plan.sustained = option("--sustained", options.sustained, Dimension::force, "500N");
  plan.punch = option("--punch", options.punch, Dimension::force, "5000N");
  if (!options.punch_duration.empty())
    plan.punch_duration = option("--punch-duration", options.punch_duration, Dimension::time, "20ms");
  if (!options.push.empty()) plan.profile = parse_push(options.push);
  return plan;
}

Rocker rocker(const RigidBody& body, const Tipping& tipping, double gravity, bool turns_with_body) {
  return {body.mass, gravity, tipping.inertia, tipping.radius, tipping.balance_angle(), tipping.lever, turns_with_body};
}

void add_push_findings(const Rocker& rocker, const PushOptions& options, const PushPlan& plan,
                       std::optional<double> friction, const Monitor& monitor, Findings& found) {
  if (!(rocker.balance > 0)) {
    found.notes.push_back("any push tips it, however small and short: it has no threshold and no boundary");
    return;
  }
  const double duration = rocker.least_duration(plan.punch, monitor), impulse = rocker.least_impulse();
  const std::vector<Finding> rows = {
      {"push_direction", "direction of a push that lasts",
       std::string(plan.turns_with_body ? "turns with the body" : "stays in space")},
      {"balance_angle_deg", "tilt from which it falls by itself", rocker.balance * degrees, "degrees"},
      {"inertia_about_pivot", "moment of inertia about the pivot edge", rocker.inertia, "kg m^2"},
      {"least_energy_J", "energy that tips it", rocker.least_energy(), "J"},
      {"least_impulse_Ns", "smallest impulse, of a short push", impulse, "N s"},
      {"sustained_N", "sustained force", plan.sustained, "N"},
      {"sustained_tips", "sustained force tips it", plan.sustained > rocker.threshold()},
      {"sustained_short_by", "force to begin over sustained force", rocker.threshold() / plan.sustained},
      {"punch_N", "punch", plan.punch, "N"},
      {"punch_least_duration_s", "least duration of the punch", finite(duration), "s",
       "never: it does not tip it, however long it lasts"},
      {"punch_impulse_Ns", "impulse of that punch", finite(duration * plan.punch), "N s", "none is enough"},
  };
  found.rows.insert(found.rows.end(), rows.begin(), rows.end());
  if (plan.punch_duration) {
    const double needed = rocker.least_force(*plan.punch_duration, monitor);
    found.rows.push_back({"punch_duration_s", "duration of the punch", *plan.punch_duration, "s"});
    found.rows.push_back({"punch_tips", "punch of that duration tips it", duration <= *plan.punch_duration});
    found.rows.push_back({"punch_force_needed_N", "force that tips it in that duration", needed, "N"});
  }
  if (plan.profile) add_profile(rocker, options, *plan.profile, friction, monitor, found);
  found.tables.push_back(boundary(rocker, options, plan, friction, monitor));
  if (friction)
    found.notes.push_back(
        "boundary: `grips` says whether this friction holds the feet; where it says no they slip, and the "
        "duration in that row, which is that of feet held where they are, does not apply");
}

} // namespace cowgpu::cli
