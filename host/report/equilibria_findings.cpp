#include "host/report/equilibria_findings.hpp"

#include "host/coefficient_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu {

using namespace physics;

namespace {

struct Names {
  std::string length, time, rate, speed_squared, force, density;
};

Names names(bool si) {
  if (si) return {"m", "s", "rad/s", "J/kg", "m/s^2", "kg/m^3"};
  const std::string length(mesh_length_unit);
  return {length,       "1/sqrt(G * density)", "sqrt(G * density)", "G * density * length^2", "G * density * length",
          "of the body"};
}

Table points_table(const EquilibriaResult& s, const Names& unit) {
  Table table{
      "equilibria",
      "equilibria from the innermost: where, Jacobi constant, kind, periods of small oscillations, and the time in "
      "which the fastest departure grows e times",
      {{"x", unit.length},
       {"y", unit.length},
       {"z", unit.length},
       {"jacobi", unit.speed_squared},
       {"inside"},
       {"kind"},
       {"period_1", unit.time},
       {"period_2", unit.time},
       {"period_3", unit.time},
       {"e_fold", unit.time},
       {"distance", unit.length, false},
       {"depth", unit.length, false},
       {"density", unit.density, false},
       {"index", "", false},
       {"frequency_1", unit.rate, false},
       {"frequency_2", unit.rate, false},
       {"frequency_3", unit.rate, false},
       {"growth_rate", unit.rate, false},
       {"growth_frequency", unit.rate, false},
       {"residual", unit.force, false},
       {"alone_within", unit.length, false}},
      {}};
  for (const Equilibrium& e : s.equilibria.points) {
    const SmallMotions& m = e.motions;
    std::vector<Value> row = {e.at[0], e.at[1], e.at[2], e.jacobi, e.inside, std::string(name(m.kind))};
    const auto frequency = [&](std::size_t i) { return i < m.frequencies.size() ? Value(m.frequencies[i]) : Value(); };
    for (std::size_t i = 0; i < 3; ++i)
      row.push_back(i < m.frequencies.size() ? Value(2 * std::numbers::pi / m.frequencies[i]) : Value());
    row.push_back(m.growth > 0 ? Value(1 / m.growth) : Value());
    row.insert(row.end(), {(e.at - s.centre_of_mass).norm(), e.depth, e.density, double(m.index)});
    for (std::size_t i = 0; i < 3; ++i) row.push_back(frequency(i));
    row.insert(row.end(), {m.growth, m.growth_frequency, e.residual, e.alone_within});
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table undecided_table(const EquilibriaResult& s, const Names& unit) {
  Table table{"undecided",
              "places where an equilibrium may be missing: balls that hold cells which the bounds do not decide",
              {{"x", unit.length},
               {"y", unit.length},
               {"z", unit.length},
               {"radius", unit.length},
               {"cells"},
               {"ring"},
               {"found"}},
              {}};
  constexpr std::size_t most = 20;
  const auto& places = s.equilibria.undecided;
  for (std::size_t i = 0; i < std::min(most, places.size()); ++i) {
    const UndecidedPlace& p = places[i];
    table.rows.push_back({p.centre[0], p.centre[1], p.centre[2], p.radius, double(p.cells), p.ring, double(p.found)});
  }
  return table;
}

void add_notes(const EquilibriaResult& s, Findings& found) {
  const Equilibria& e = s.equilibria;
  found.notes.push_back("in the frame that turns with the body: the Jacobi constant is v^2/2 less the square of (rate "
                        "times distance from the "
                        "axis)/2 plus the potential, which is negative; at an equilibrium v = 0");
  if (e.complete())
    found.notes.push_back(
        "these are all: every other place is excluded by bounds on how fast gravity changes, and the signs of their "
        "determinants add up to -1, as they must (Poincare and Hopf)");
  else if (e.index_sum != -1)
    found.notes.push_back(fmt::format(
        "the signs of their determinants add up to {} and not to -1, as those of all equilibria that are not "
        "degenerate do (Poincare and Hopf): some are missing, or not isolated",
        e.index_sum));
  if (e.exhausted)
    found.notes.push_back(fmt::format("the search ended after {} places, before its cells were as small as asked for; "
                                      "--cells allows more",
                                      e.places));
  if (e.undecided_cells > 0)
    found.notes.push_back(
        fmt::format("{} cells, in {} group{}, are not decided{}: an equilibrium may be missing there{}",
                    e.undecided_cells, e.undecided.size(), e.undecided.size() == 1 ? "" : "s",
                    e.exhausted ? "" : " at their smallest size", e.exhausted ? "" : "; --smallest refines further"));
  if (std::any_of(e.undecided.begin(), e.undecided.end(), [](const UndecidedPlace& p) { return p.ring; }))
    found.notes.push_back(
        "a group of them goes round the axis: the body is all but symmetric about it, and its equilibria "
        "form a ring, of which any that are listed are those of its facets");
  if (e.largest_winding > 1)
    found.notes.push_back(fmt::format("surfaces wind up to {} times about places that were looked at; where they do so "
                                      "more often, the bounds do not hold",
                                      e.largest_winding));
}

} // namespace

Findings findings(const EquilibriaResult& s) {
  Findings found(s.subject);
  const Names unit = names(s.si);
  const Equilibria& e = s.equilibria;
  if (!s.si)
    found.notes.push_back("lengths and densities are in the mesh's units and G = 1; --length-unit or --length, and "
                          "--density or --mass, make it SI");
  add_notes(s, found);
  const auto count = [&](auto&& which) { return double(std::count_if(e.points.begin(), e.points.end(), which)); };
  found.rows = {{"mass", "mass", s.mass, s.si ? "kg" : "density * length^3"},
                {"density", "density", s.density, unit.density},
                {"constant", "Newton's constant", s.constant, s.si ? "m^3/(kg s^2)" : ""},
                {"centre_of_mass", "centre of mass", s.centre_of_mass, unit.length},
                {"spin_axis", s.axis_found ? "spin axis, of the largest moment" : "spin axis", s.spin.axis},
                {"spin_rate", "spin rate", s.spin.rate, unit.rate},
                {"spin_period", "period of the spin", 2 * std::numbers::pi / s.spin.rate, unit.time},
                {"synchronous_radius", "synchronous radius, of a point mass", s.synchronous, unit.length},
                {"equilibrium_count", "equilibria", double(e.points.size())},
                {"outside_count", "equilibria outside the body", count([](const Equilibrium& p) { return !p.inside; })},
                {"stable_count", "stable equilibria",
                 count([](const Equilibrium& p) { return p.motions.kind == EquilibriumKind::stable; })},
                {"complete", "all of them are known", e.complete()},
                {"index_sum", "sum of the signs of determinants", double(e.index_sum)},
                {"farthest", "none farther from the axis than", e.farthest, unit.length},
                {"cells", "cells looked at", double(e.places)},
                {"undecided_count", "cells left undecided", double(e.undecided_cells)},
                {"smallest_cell", "half diagonal of the smallest cells", e.smallest_cell, unit.length},
                {"device", "device", s.device}};
  if (s.zero_velocity) {
    const auto& z = *s.zero_velocity;
    found.rows.push_back({"surface_jacobi", "zero-velocity surface of", z.jacobi, unit.speed_squared});
    found.rows.push_back({"surface_triangles", "its triangles", double(z.surface.faces.size())});
    found.rows.push_back({"surface_extent", "half side of the cube that it is in", z.extent, unit.length});
    found.rows.push_back({"surface_cell", "side of its cells", z.cell, unit.length});
  }
  if (!e.points.empty()) found.tables.push_back(points_table(s, unit));
  if (!e.undecided.empty()) found.tables.push_back(undecided_table(s, unit));
  return found;
}

} // namespace cowgpu
