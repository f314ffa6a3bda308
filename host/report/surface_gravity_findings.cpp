#include "host/report/surface_gravity_findings.hpp"

#include "host/coefficient_set.hpp"
#include "host/physics/far_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cowgpu {

using namespace physics;

namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr double slope_bin = 5; // degrees

struct SurfaceUnits {
  std::string length, potential, gravity, rate, speed, density, mass, volume, area, constant;
};

SurfaceUnits units_of(const SurfaceGravityResult& s) {
  if (s.si) return {"m", "J/kg", "m/s^2", "rad/s", "m/s", "kg/m^3", "kg", "m^3", "m^2", "m^3/(kg s^2)"};
  const std::string length(mesh_length_unit);
  return {length,
          "G * density * length^2",
          "G * density * length",
          "sqrt(G * density)",
          "sqrt(G * density) * length",
          "of the mesh",
          std::string(mesh_mass_unit),
          "length^3",
          "length^2",
          ""};
}

std::vector<double> flattened(std::vector<Vec3>& vectors) {
  std::vector<double> flat;
  flat.reserve(3 * vectors.size());
  for (const Vec3& v : vectors) flat.insert(flat.end(), {v.x(), v.y(), v.z()});
  vectors = {};
  return flat;
}

std::vector<double> norms(const std::vector<Vec3>& vectors) {
  std::vector<double> all;
  all.reserve(vectors.size());
  for (const Vec3& v : vectors) all.push_back(v.stableNorm());
  return all;
}

std::vector<double> in_degrees(std::vector<double> angles) {
  for (double& angle : angles) angle *= degrees;
  return angles;
}

// What a note and the file say of the signs.
std::string sign_note(const SurfaceGravityResult& s) {
  std::string text =
      s.spin ? "potential is that of the attraction, below 0 and 0 far away; g holds the centrifugal "
               "acceleration, and geopotential is the potential less half the square of the speed of turning"
             : "potential is below 0 and 0 far away, g its fall; the body does not spin, so that "
               "geopotential is the potential";
  if (s.values.place != ValuePlace::points) return text + "; elevation is above 0 where water would flow away";
  return text + "; points have no normal: slope, elevation and tilt are those of faces and vertices";
}

// Least, greatest and mean (by area where there is one) of the values that are numbers.
struct Range {
  double least = 0, greatest = 0, mean = 0;
  std::size_t count = 0, left_out = 0;
};

Range range_of(const ValueColumn& column, const std::vector<double>& areas) {
  Range range;
  long double sum = 0, weight = 0;
  for (std::size_t i = 0; i < column.values.size(); ++i) {
    const double value = column.values[i], w = areas.empty() ? 1 : areas[i];
    if (!std::isfinite(value)) {
      ++range.left_out;
      continue;
    }
    range.least = range.count ? std::min(range.least, value) : value;
    range.greatest = range.count ? std::max(range.greatest, value) : value;
    ++range.count;
    sum += (long double)(w)*value;
    weight += w;
  }
  range.mean = weight > 0 ? double(sum / weight) : 0;
  return range;
}

void add_ranges(const SurfaceGravityResult& s, Findings& found) {
  const bool plates = !s.areas.empty();
  Table table{"ranges",
              plates ? "ranges over the places, and means by area" : "ranges over the places, and means",
              {{"quantity"}, {"unit"}, {"least"}, {"mean"}, {"greatest"}, {"meaning", {}, false}},
              {}};
  for (const ValueColumn& column : s.values.columns) {
    if (column.components != 1) continue;
    const Range range = range_of(column, s.areas);
    if (range.left_out > 0)
      found.notes.push_back(fmt::format("{} is no number at {} of {} places, where g is 0", column.name, range.left_out,
                                        s.values.places.size()));
    if (range.count == 0) continue;
    table.rows.push_back({column.name, column.unit, range.least, range.mean, range.greatest, column.meaning});
  }
  found.tables.push_back(std::move(table));
}

void add_slopes(const SurfaceGravityResult& s, Findings& found) {
  const auto slope = std::find_if(s.values.columns.begin(), s.values.columns.end(),
                                  [](const ValueColumn& column) { return column.name == "slope"; });
  if (slope == s.values.columns.end()) return;
  std::vector<long double> bins(std::size_t(180 / slope_bin));
  long double total = 0;
  std::size_t overhanging = 0;
  for (std::size_t i = 0; i < slope->values.size(); ++i) {
    const double value = slope->values[i];
    bins[std::min(bins.size() - 1, std::size_t(value / slope_bin))] += s.areas[i];
    total += s.areas[i];
    overhanging += value > 90 ? 1 : 0;
  }
  while (!bins.empty() && bins.back() == 0) bins.pop_back();
  Table table{
      "slopes", "slopes, by area", {{"from", "deg"}, {"to", "deg"}, {"area_fraction"}, {"steeper_fraction"}}, {}};
  for (std::size_t b = 0; b < bins.size(); ++b) {
    long double steeper = 0; // summed, so that behind the last there is nothing
    for (std::size_t c = b + 1; c < bins.size(); ++c) steeper += bins[c];
    table.rows.push_back(
        {slope_bin * double(b), slope_bin * double(b + 1), double(bins[b] / total), double(steeper / total)});
  }
  found.tables.push_back(std::move(table));
  if (overhanging > 0)
    found.notes.push_back(fmt::format("at {} of {} places the slope is above 90 degrees: what lies there falls off",
                                      overhanging, slope->values.size()));
}

void add_notes(const SurfaceGravityResult& s, Findings& found) {
  if (!s.si)
    found.notes.push_back("lengths and densities are in the mesh's units and G = 1; --length-unit or --length, and "
                          "--density or --mass, make it SI");
  found.notes.insert(found.notes.end(), s.values.notes.begin(), s.values.notes.end());
  if (s.far_points > 0)
    found.notes.push_back(
        fmt::format("at {} of {} places, far away, the body's series to degree {} about the middle of "
                    "its box is nearer to the truth than sums over its faces, and was taken",
                    s.far_points, s.values.places.size(), FarField::degree));
}

} // namespace

void take_columns(SurfaceGravity gravity, std::vector<double> bound, SurfaceGravityResult& s) {
  const SurfaceUnits u = units_of(s);
  std::vector<ValueColumn>& columns = s.values.columns;
  const auto add = [&](const char* name, const std::string& unit, const std::string& meaning,
                       std::vector<double> values, int components = 1) {
    columns.push_back({name, unit, meaning, components, std::move(values)});
  };
  const std::string turning = s.spin ? ", the centrifugal acceleration in it" : "";
  add("potential", u.potential, "potential of the attraction, below 0 and 0 far away", std::move(gravity.potential));
  std::vector<double> sizes = norms(gravity.gravity);
  add("g", u.gravity, "acceleration of what lies there" + turning, flattened(gravity.gravity), 3);
  add("g", u.gravity, "size of that acceleration", std::move(sizes));
  add("geopotential", u.potential,
      s.spin ? "potential less half the square of the speed of turning; g is its fall"
             : "potential, since the body does not spin; g is its fall",
      std::move(gravity.geopotential));
  if (s.values.place != ValuePlace::points) {
    const std::string normal = s.values.place == ValuePlace::faces
                                   ? "the outward normal of the face"
                                   : "the outward normal of the vertex, the mean of its faces' by their angles";
    add("slope", "deg", "angle between -g and " + normal, in_degrees(std::move(gravity.slope)));
    add("elevation", u.length,
        "geopotential less its mean over the places by area, over the size of g; above 0 where water would flow away",
        std::move(gravity.elevation));
    add("escape_speed", u.speed, "speed seen from outside, where the body spins, that leaves it for ever",
        std::move(gravity.escape_speed));
    add("tilt", "deg", "angle between " + normal + " and the way to the place from the body's centre of mass",
        in_degrees(std::move(gravity.tilt)));
  } else {
    add("escape_speed", u.speed, "speed seen from outside, where the body spins, that leaves it for ever",
        std::move(gravity.escape_speed));
  }
  if (!bound.empty())
    add("g_bound", u.gravity, "proven bound of what the fast sum leaves out of g, rounding aside", std::move(bound));
  s.values.length_unit = s.si ? "m" : "";
  if (!s.si)
    for (ValueColumn& column : columns)
      if (column.unit == u.length) column.unit = "length of the mesh";
  s.values.notes.push_back(sign_note(s));
}

std::uint64_t surface_gravity_numbers(ValuePlace place, bool guarantee) {
  return (place == ValuePlace::points ? 7 : 10) + (guarantee ? 1 : 0);
}

Findings findings(const SurfaceGravityResult& s) {
  Findings found(s.subject);
  const SurfaceUnits u = units_of(s);
  add_notes(s, found);
  found.rows = {{"constant", "Newton's constant", s.constant, u.constant},
                {"density", "density", s.density, u.density},
                {"volume", "volume", s.volume, u.volume},
                {"area", "area of the surface", s.area, u.area},
                {"mass", "mass", s.mass, u.mass},
                {"size", "sides of its box", s.size, u.length},
                {"radius", "radius R of a ball of that volume", s.radius, u.length},
                {"centre_of_mass", "centre of mass", s.centre_of_mass, u.length},
                {"gravity_scale", "G M/R^2", s.gravity_scale, u.gravity}};
  if (s.spin) {
    found.rows.push_back({"spin_rate", "rate of the spin", s.spin->rate, u.rate});
    found.rows.push_back(
        {"spin_period", "period of the spin", 2 * std::numbers::pi / s.spin->rate, s.si ? "s" : "1/sqrt(G * density)"});
    found.rows.push_back({"spin_axis", "axis of the spin", s.spin->axis});
    found.rows.push_back({"spin_through", "point that the axis runs through", s.spin->through, u.length});
  }
  found.rows.push_back({"places", "places", s.places});
  found.rows.push_back({"place_count", "number of places", double(s.values.places.size())});
  if (s.height != 0) found.rows.push_back({"height", "height above them", s.height, u.length});
  if (!s.areas.empty())
    found.rows.push_back({"mean_geopotential", "mean geopotential, of elevation 0", s.mean_geopotential, u.potential});
  found.rows.push_back({"tolerance", "tolerance of g, in G M/R^2", s.tolerance});
  found.rows.push_back({"guarantee", "truncation of g is proven", s.guarantee});
  found.rows.push_back({"gravity_error", "estimated error of g", s.gravity_error, u.gravity});
  found.rows.push_back({"potential_error", "estimated error of the potential", s.potential_error, u.potential});
  found.rows.push_back({"far_count", "places by the body's series", double(s.far_points)});
  found.rows.push_back({"seconds", "seconds of the sum", s.run.seconds, "s"});
  found.rows.push_back({"device", "device", s.device});
  add_ranges(s, found);
  add_slopes(s, found);
  return found;
}

} // namespace cowgpu
