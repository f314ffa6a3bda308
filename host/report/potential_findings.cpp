#include "host/report/potential_findings.hpp"

#include "host/coefficient_set.hpp"
#include "host/physics/far_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace cowgpu {

using namespace physics;

namespace {

const char* force_name(const PotentialResult& s) {
  return s.law.charge ? "field" : "acceleration";
}

void add_one_point(const PotentialResult& s, const FieldUnits& units, Findings& found) {
  const PotentialField& f = s.field;
  found.rows.push_back({"at", "place", s.points[0], units.length});
  found.rows.push_back({"potential", "potential", f.value[0], units.potential});
  if (!f.gradient.empty()) found.rows.push_back({force_name(s), force_name(s), f.gradient[0], units.force});
  if (!f.hessian.empty()) {
    const SymmetricTensor& h = f.hessian[0];
    Eigen::Matrix3d tensor;
    tensor << h[0], h[1], h[2], h[1], h[3], h[4], h[2], h[4], h[5];
    found.rows.push_back({"gradient", fmt::format("gradient of the {}", force_name(s)), tensor, units.tensor});
  }
  if (!s.induction.empty()) found.rows.push_back({"induction", "magnetic induction B", s.induction[0], "T"});
  if (!s.density.empty())
    found.rows.push_back(
        {"density", "density at the place", s.density[0], s.si ? (s.law.charge ? "C/m^3" : "kg/m^3") : "of the body"});
}

void add_ranges(const PotentialResult& s, const FieldUnits& units, Findings& found) {
  const auto [least, most] = std::minmax_element(s.field.value.begin(), s.field.value.end());
  found.rows.push_back({"potential_min", "least potential", *least, units.potential});
  found.rows.push_back({"potential_max", "greatest potential", *most, units.potential});
  if (!s.induction.empty()) {
    const auto size = [](const Vec3& a, const Vec3& b) { return a.norm() < b.norm(); };
    const auto [weak, strong] = std::minmax_element(s.induction.begin(), s.induction.end(), size);
    found.rows.push_back({"induction_min", "least magnetic induction B", weak->norm(), "T"});
    found.rows.push_back({"induction_max", "greatest magnetic induction B", strong->norm(), "T"});
  }
  if (s.field.gradient.empty()) return;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const Vec3& g : s.field.gradient) {
    low = std::min(low, g.norm());
    high = std::max(high, g.norm());
  }
  const std::string name = force_name(s);
  found.rows.push_back({name + "_min", "least " + name, low, units.force});
  found.rows.push_back({name + "_max", "greatest " + name, high, units.force});
}

void add_table(const PotentialResult& s, const FieldUnits& units, std::size_t most_points, Findings& found) {
  const std::size_t count = s.points.size();
  if (count > most_points) {
    found.notes.push_back(fmt::format("{} points: -o FILE.csv writes each of them", count));
    return;
  }
  Table table{"points", "point by point", {{"x", units.length}, {"y", units.length}, {"z", units.length}}, {}};
  table.columns.push_back({"potential", units.potential});
  const char letter = s.law.charge ? 'e' : 'a';
  if (!s.field.gradient.empty())
    for (const char c : {'x', 'y', 'z'}) table.columns.push_back({fmt::format("{}{}", letter, c), units.force});
  if (!s.field.hessian.empty())
    for (const char* c : {"xx", "xy", "xz", "yy", "yz", "zz"})
      table.columns.push_back({fmt::format("{}{}", letter, c), units.tensor});
  if (!s.induction.empty())
    for (const char* c : {"b_x", "b_y", "b_z"}) table.columns.push_back({c, "T"});
  table.columns.push_back({"exact"});
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& p = s.points[i];
    std::vector<Value> row = {p[0], p[1], p[2], s.field.value[i]};
    if (!s.field.gradient.empty())
      for (int c = 0; c < 3; ++c) row.emplace_back(s.field.gradient[i][c]);
    if (!s.field.hessian.empty()) row.insert(row.end(), s.field.hessian[i].begin(), s.field.hessian[i].end());
    if (!s.induction.empty())
      for (int c = 0; c < 3; ++c) row.emplace_back(s.induction[i][c]);
    row.emplace_back(!s.exact.empty() && s.exact[i] != 0);
    table.rows.push_back(row);
  }
  found.tables.push_back(std::move(table));
}

// Which places have the closed form, which its series, and what doubles do not hold.
void add_exact_notes(const PotentialResult& s, Findings& found) {
  const std::size_t count = s.points.size(), closed = s.exact_points + s.far_points;
  if (s.all_exact && s.far_points == 0)
    found.notes.push_back("everywhere the exact potential of the polyhedron (Werner and Scheeres 1997)");
  else if (!s.all_exact && closed > 0)
    found.notes.push_back(
        fmt::format("{} of {} points lie inside the sphere that holds the body: there the exact potential "
                    "of the polyhedron (Werner and Scheeres 1997)",
                    closed, count));
  if (s.far_points > 0)
    found.notes.push_back(fmt::format("at {} of {} points the closed form of the polyhedron (Werner and Scheeres "
                                      "1997), a difference of large numbers "
                                      "far away and beside thin bodies, has larger errors than the body's series to "
                                      "degree {} about the middle of its "
                                      "box, and that series was taken",
                                      s.far_points, count, FarField::degree));
  std::size_t lost = 0;
  constexpr double least = std::numeric_limits<double>::min();
  for (std::size_t i = 0; i < count; ++i) {
    if (s.field.value[i] == 0) continue;
    const auto small = [](double component) { return std::abs(component) < least; };
    const bool force = !s.field.gradient.empty() && !(s.field.gradient[i].cwiseAbs().maxCoeff() >= least);
    const bool tensor =
        !s.field.hessian.empty() && std::all_of(s.field.hessian[i].begin(), s.field.hessian[i].end(), small);
    lost += force || tensor ? 1 : 0;
  }
  if (lost > 0)
    found.notes.push_back(fmt::format("at {} of {} points, far away, derivatives of the potential are smaller than "
                                      "doubles hold in all their digits ({:.3g}), and may be shown as 0",
                                      lost, count, least));
}

void add_head(const PotentialResult& s, const FieldUnits& units, Findings& found) {
  if (!s.si)
    found.notes.push_back(
        fmt::format("lengths and densities are in the mesh's units and {} = 1; --length-unit or --length, "
                    "and --density, make it SI",
                    s.law.charge ? "k" : "G"));
  if (s.law.charge)
    found.notes.push_back("densities are of charge: potential k Q/r, field -grad of it, away from positive charges");
  if (s.magnetisation)
    found.notes.push_back(
        "the magnetisation is the given one times the density, 1 in the mesh; B = mu_0 (H + M), from the "
        "second derivatives of the potential of that density; potential and acceleration are those of "
        "gravity");
  if (!s.origin_known) found.notes.push_back("the file does not say its origin: places are counted from it");
  add_exact_notes(s, found);
  if (const double rest = std::pow(s.nearest, -(s.lmax + 1));
      s.radius_known() && rest > 1e-12) // as many digits are shown
    found.notes.push_back(fmt::format(
        "the nearest point of the series is {:.6g} radii away: to degree {} its terms have fallen "
        "to {:.2g} there at most; {} is nearer to the truth",
        s.nearest, s.lmax, rest,
        !s.reference_radius ? "a higher --lmax, or --exact," : "the mesh, with --exact or a higher --lmax,"));
  if (!s.radius_known()) {
    found.notes.push_back(s.radius_note +
                          "; 1R is the reference radius here, and the sum of the file's terms is taken everywhere");
    if (s.nearest < 1)
      found.notes.push_back(fmt::format("the nearest point is {:.6g} reference radii from the origin: the field is "
                                        "continued downwards to it, and terms of degree {} and their errors have "
                                        "grown {:.3g} times",
                                        s.nearest, s.lmax, std::pow(s.nearest, -(s.lmax + 1))));
  }
  found.rows = {{"law", "law", std::string(s.law.charge ? "charge" : "gravity")},
                {"constant", s.law.charge ? "Coulomb's constant" : "Newton's constant", s.law.constant,
                 s.si ? (s.law.charge ? "N m^2/C^2" : "m^3/(kg s^2)") : ""},
                {"lmax", "series to degree", s.all_exact ? Value() : Value(double(s.lmax))},
                {"origin", "origin", s.origin, units.length},
                {"brillouin_radius", "Brillouin radius", s.radius_known() ? Value(s.radius) : Value(), units.length,
                 "not known: the file does not say it"},
                {"places", "places", s.places},
                {"point_count", "points", double(s.points.size())},
                {"exact_count", "points by the polyhedron's closed form", double(s.exact_points)}};
  if (s.exact_points + s.far_points > 0) {
    found.rows.push_back({"far_count", "points by the polyhedron's series", double(s.far_points)});
    found.rows.push_back({"exact_error", "estimated relative error at these",
                          std::isfinite(s.exact_error) ? Value(s.exact_error) : Value(), "",
                          "none: the potential is 0"});
  }
  if (s.magnetisation) found.rows.push_back({"magnetisation", "magnetisation", *s.magnetisation, "A/m"});
  if (s.reference_radius)
    found.rows.push_back({"reference_radius", "reference radius of the file", *s.reference_radius, units.length});
}

void add_errors(const SeriesErrors& errors, Findings& found) {
  found.rows.push_back({"directions", "directions of root mean squares", double(errors.directions)});
  found.rows.push_back({"truth_from", "distance from which a series is truth", errors.truth_from, "radii"});
  found.rows.push_back({"truth_degree", "degree of that series", double(errors.truth_degree)});
  found.rows.push_back({"truth_error", "error of that series at that distance", errors.truth_error});
  Table table{
      "errors",
      "relative errors of the series, by distance in Brillouin radii and order",
      {{"distance"}, {"order"}, {"potential_max"}, {"potential_rms"}, {"acceleration_max"}, {"acceleration_rms"}},
      {}};
  for (const SeriesError& e : errors.rows)
    table.rows.push_back(
        {e.distance, double(e.order), e.potential_max, e.potential_rms, e.acceleration_max, e.acceleration_rms});
  Table good{"good_from",
             "from which distance on, in Brillouin radii, an order is right to 1e-3, 1e-6 and 1e-9 in every direction, "
             "potential and acceleration",
             {{"order"}, {"1e-3"}, {"1e-6"}, {"1e-9"}},
             {}};
  for (const GoodFrom& g : errors.good_from) {
    std::vector<Value> row = {double(g.order)};
    for (const auto& distance : g.distance) {
      row.emplace_back();
      if (distance) row.back() = *distance;
    }
    good.rows.push_back(row);
  }
  found.tables = {std::move(table), std::move(good)};
}

} // namespace

FieldUnits field_units(const PotentialResult& result) {
  const bool charge = result.law.charge;
  if (result.si) return {"m", charge ? "V" : "J/kg", charge ? "V/m" : "m/s^2", charge ? "V/m^2" : "1/s^2"};
  const std::string g = charge ? "k" : "G";
  return {std::string(mesh_length_unit), g + " * density * length^2", g + " * density * length", g + " * density"};
}

Findings findings(const PotentialResult& s, std::size_t most_points) {
  Findings found(s.subject);
  const FieldUnits units = field_units(s);
  add_head(s, units, found);
  if (s.points.size() == 1) {
    add_one_point(s, units, found);
  } else {
    add_ranges(s, units, found);
    add_table(s, units, most_points, found);
  }
  found.rows.push_back({"device", "device", s.device});
  return found;
}

PotentialTable potential_table(const PotentialResult& s) {
  const FieldUnits units = field_units(s);
  return {s.subject.name, s.points,     s.field, s.exact,         s.law.charge, units.length, units.potential,
          units.force,    units.tensor, s.grid,  s.sphere_radius, s.induction,  s.lattice};
}

Findings findings(const SeriesErrorsResult& result) {
  Findings found(result.subject);
  const std::string length(result.si ? "m" : mesh_length_unit);
  found.notes.push_back(fmt::format(
      "the truth is the exact potential of the polyhedron (Werner and Scheeres 1997), from {:.4g} radii on the series "
      "to degree {}",
      result.errors.truth_from, result.errors.truth_degree));
  found.notes.push_back("the largest errors are searched: on a grid that resolves the first degrees left out, at the "
                        "ends of the axes, over the outermost vertices, and uphill from the best of these; rounding, "
                        "about 1e-15, is not in them");
  found.rows = {{"origin", "origin", result.origin, length},
                {"brillouin_radius", "Brillouin radius", result.radius, length}};
  add_errors(result.errors, found);
  return found;
}

} // namespace cowgpu
