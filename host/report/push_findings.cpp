#include "host/report/push_findings.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace cowgpu {

using namespace physics;

namespace {

constexpr double in_degrees = 180 / std::numbers::pi;

Value finite(double value) {
  return std::isfinite(value) ? Value(value) : Value();
}

std::string name(Outcome outcome) {
  if (outcome == Outcome::tipped) return "tips over";
  return outcome == Outcome::fell_back ? "lifts off and falls back" : "never lifts off";
}

Table boundary_table(const PushOutcome& outcome, const std::optional<double>& friction) {
  Table table{"boundary",
              "how long a constant push must last to tip it, its feet held where they are (-: it never does)",
              {{"force_N", "N"}, {"least_duration_s", "s"}, {"impulse_Ns", "N s"}, {"friction_needed"}, {"mark"}},
              {}};
  if (friction) table.columns.insert(table.columns.end() - 1, {"grips"});
  for (const BoundaryPoint& point : outcome.boundary) {
    std::vector<Value> values = {point.force, finite(point.least_duration), finite(point.least_duration * point.force),
                                 finite(point.friction_needed)};
    if (friction) values.emplace_back(point.friction_needed <= *friction);
    values.emplace_back(point.mark);
    table.rows.push_back(std::move(values));
  }
  return table;
}

void add_profile(const PushOutcome& outcome, const std::optional<double>& friction, Findings& found) {
  const PushResult& result = *outcome.pushed;
  const bool lifted = result.outcome != Outcome::never_lifted;
  const std::vector<Finding> rows = {
      {"push", "push", outcome.asked.profile_name},
      {"push_impulse_Ns", "impulse of the push", outcome.asked.profile->impulse(), "N s"},
      {"push_outcome", "outcome of the push", name(result.outcome)},
      {"push_tips", "push tips it over", result.outcome == Outcome::tipped},
      {"push_peak_tilt_deg", "largest tilt under the push", result.peak_tilt * in_degrees, "degrees"},
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

void add_findings(const PushOutcome& outcome, std::optional<double> friction, Findings& found) {
  const PushRequest& plan = outcome.asked;
  const Rocker& rocker = outcome.rocker;
  const double duration = outcome.punch_least_duration, impulse = rocker.least_impulse();
  const std::vector<Finding> rows = {
      {"push_direction", "direction of a push that lasts",
       std::string(plan.turns_with_body ? "turns with the body" : "stays in space")},
      {"balance_angle_deg", "tilt from which it falls by itself", rocker.balance * in_degrees, "degrees"},
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
    found.rows.push_back({"punch_duration_s", "duration of the punch", *plan.punch_duration, "s"});
    found.rows.push_back({"punch_tips", "punch of that duration tips it", duration <= *plan.punch_duration});
    found.rows.push_back(
        {"punch_force_needed_N", "force that tips it in that duration", *outcome.punch_force_needed, "N"});
  }
  if (outcome.pushed) add_profile(outcome, friction, found);
  found.tables.push_back(boundary_table(outcome, friction));
  if (friction)
    found.notes.push_back(
        "boundary: `grips` says whether this friction holds the feet; where it says no they slip, and the "
        "duration in that row, which is that of feet held where they are, does not apply");
}

} // namespace cowgpu
