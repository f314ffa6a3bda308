#include "host/report/tip_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cowgpu {

using namespace physics;

namespace {

constexpr double degrees = 180 / std::numbers::pi;

// Forces in newtons, where there are any.
struct Weight {
  double newtons = 0;
  bool metric = false;
  Value of(double force) const { return metric ? Value(force * newtons) : Value(); }
  Value of(const std::optional<double>& force) const { return force ? of(*force) : Value(); }
};

std::vector<Value> order_row(const Value& order, const TippingForces& s, bool metric, const std::string& note) {
  const Tipping& t = s.chosen();
  const Weight weight{s.weight(), metric};
  const Rocker body = rocker(s.mass, t, s.gravity, true);
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
          s.settle_angle * degrees,
          note};
}

std::string order_note(const TippingForces& stood, const std::string& first) {
  std::string note = first;
  const auto add = [&](const char* text) { note += (note.empty() ? "" : "; ") + std::string(text); };
  if (stood.chosen().rolls) add("rolls over the point that it touches at");
  if (stood.held) add("held fore and aft");
  return note;
}

Table orders_table(const TipResult& result, const std::string& length) {
  const bool metric = result.body.units.stated;
  Table table{"orders",
              fmt::format("by order{}: the force that begins to tip it, and to which side",
                          result.expansion.empty() ? "" : " of " + result.expansion),
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
  for (const TippedOrder& order : result.orders) {
    if (order.forces) {
      table.rows.push_back(
          order_row(double(order.order), *order.forces, metric, order_note(*order.forces, order.note)));
      continue;
    }
    std::vector<Value> row(table.columns.size());
    row.front() = double(order.order);
    row.back() = order.note;
    table.rows.push_back(std::move(row));
  }
  table.rows.push_back(order_row(std::string("full"), result.forces, metric,
                                 order_note(result.forces, result.body_is == "the mesh" ? "" : result.body_is)));
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

void add_force_rows(const TipResult& result, const std::string& length, Findings& found) {
  const Stance& stance = result.stance;
  const TippingForces& stood = result.forces;
  const Tipping& t = stood.chosen();
  const bool metric = result.body.units.stated;
  const Weight weight{stood.weight(), metric};
  found.rows = {
      {"body", "body", result.body_is},
      {"attitude", "attitude", std::string(result.as_modelled ? "as modelled" : "settled")},
      {"settle_angle_deg", "angle turned to settle", stance.attitude.angle * degrees, "degrees"},
      {"settle_rolls", "rolls until it rests", double(stance.attitude.rolls.size())},
      {"support_points", "vertices that touch the ground", double(stance.contact.support.size())},
      {"over_patch", "barycentre over the contact patch", !stance.held},
      {"mass_kg", "mass", metric ? Value(stance.body.mass) : Value(), "kg"},
      {"gravity", "gravity", stood.gravity, "m/s^2"},
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
       metric ? "none: its ray meets no surface" : "not known"},
      {"force_left_N", "force to begin, to the left", weight.of(stood.left.force), "N"},
      {"force_right_N", "force to begin, to the right", weight.of(stood.right.force), "N"},
      {"friction_needed", "friction coefficient not to slip", t.friction_needed},
  };
  if (!result.friction) return;
  const double friction = *result.friction, slip = t.slip_force(friction);
  found.rows.push_back({"friction", "friction coefficient", friction});
  found.rows.push_back({"slip_force_N", "force that makes it slip", weight.of(slip), "N"});
  found.rows.push_back({"slip_force_over_weight", "slip force over the weight", slip});
  found.rows.push_back({"slips_before_tipping", "slips before it tips", friction < t.friction_needed});
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

void add_notes(const TipResult& result, Findings& found) {
  const Stance& stance = result.stance;
  if (!result.body.units.stated)
    found.notes.push_back("no unit of length was stated: forces are in units of the body's weight; --length or "
                          "--length-unit, with --density, make them newtons");
  if (!result.as_modelled && stance.attitude.angle == 0)
    found.notes.push_back("settled: it stands as modelled, its barycentre over a facet of its hull");
  else if (!result.as_modelled)
    found.notes.push_back(settled_note(stance.attitude));
  if (stance.attitude.balanced)
    found.notes.push_back(
        "on the way it stood on a corner or an edge in balance; it was made to fall to the right, or off the "
        "edge");
  if (stance.held)
    found.notes.push_back(
        "the barycentre is not over the contact patch: unless it is held it falls fore or aft first; only "
        "torque about x counts here");
  if (result.forces.chosen().rolls)
    found.notes.push_back(
        "the body is smooth and touches the ground right under its barycentre: it rolls over that point");
  if (!stance.body.smooth && narrow(stance))
    found.notes.push_back(
        "the contact patch is no wider than a few triangles: if they stand for a smooth surface, --smooth "
        "lets it roll over the point where it touches");
  if (!result.orders.empty())
    found.notes.push_back("orders have the mass of the whole; where their surface crosses itself, regions count by how "
                          "often it winds round them; an order that cannot stand has no force");
  found.notes.push_back(
      "the force acts at the last point of the ray from the pivot through the barycentre, at right angles "
      "to it; the paper's balance about the barycentre leaves out friction's torque");
}

} // namespace

Findings findings(const TipResult& result) {
  Findings found(result.subject);
  const bool metric = result.body.units.stated;
  const std::string length = metric ? "m" : "mesh units";
  add_notes(result, found);
  add_force_rows(result, length, found);
  if (!result.stance.attitude.rolls.empty()) found.tables.push_back(rolls_table(result.stance.attitude, length));
  found.tables.push_back(patch_table(result.stance, length));
  if (result.push)
    add_findings(*result.push, result.friction, found);
  else if (metric)
    found.notes.push_back("any push tips it, however small and short: it has no threshold and no boundary");
  found.tables.push_back(orders_table(result, length));
  return found;
}

} // namespace cowgpu
