#include "host/report/radiation_findings.hpp"

#include "host/units.hpp"

#include <cmath>

namespace cowgpu {

using namespace physics;

namespace {

// In the mesh's unit and density, as the paper has it.
double in_mesh_units(const RadiationResult& r, double square) {
  const Units& units = r.body.units;
  const double unit = units.kilogram * units.metre * units.metre;
  return square / (unit * unit);
}

void add_octupole(const RadiationResult& r, Findings& found) {
  if (!r.octupole) return;
  found.notes.push_back(
      "octupole and current quadrupole are of the order (omega R/c)^2 beside the quadrupole, as is its "
      "own relativistic correction, which is not among them");
  const double length = r.body.units.metre;
  const char* unit = "(unit of mass * length^3)^2";
  found.rows.push_back({"octupole_square_over_omega8", "mass octupole I''''^2 / omega^8",
                        in_mesh_units(r, *r.octupole) / (length * length), unit});
  found.rows.push_back({"current_quadrupole_square_over_omega8", "current quadrupole J'''^2 / omega^8",
                        in_mesh_units(r, *r.current_quadrupole) / (length * length), unit});
  if (!r.body.units.stated) return;
  found.rows.push_back(
      {"octupole_power_W", "power of the mass octupole", double(octupole_power(*r.octupole, r.omega)), "W"});
  found.rows.push_back({"current_quadrupole_power_W", "power of the current quadrupole",
                        double(current_quadrupole_power(*r.current_quadrupole, r.omega)), "W"});
}

} // namespace

Findings findings(const RadiationResult& r) {
  Findings found(r.subject);
  const bool si = r.body.units.stated, lasts = r.spin && std::isfinite(r.spin->timescale);
  const auto of_spin = [&](auto member) { return r.spin ? Value(double(*r.spin.*member)) : Value(); };
  const Value power = si ? Value(double(r.power)) : Value(), erg = si ? Value(double(r.power * 1e7L)) : Value();
  found.rows = {
      {"axis", "axis", r.axis},
      {"omega_rad_per_s", "angular frequency", r.omega, "rad/s"},
      {"length_unit_m", "unit of length", si ? Value(r.body.units.metre) : Value(), "m"},
      {"mass_unit_kg", "unit of mass, density times its cube", si ? Value(r.body.units.kilogram) : Value(), "kg"},
      {"mass_kg", "mass", si ? Value(r.body.mass) : Value(), "kg"},
      {"qdddot2_over_omega6", "Q'''_ij Q'''_ij / omega^6", in_mesh_units(r, r.square), "(unit of mass * length^2)^2"},
      {"qdddot2_over_omega6_SI", "Q'''_ij Q'''_ij / omega^6, SI", si ? Value(r.square) : Value(), "kg^2 m^4"},
      {"spherical_difference", "difference from the spherical formula", r.spherical_difference,
       "of 64 Q_ij Q_ij, which it cannot exceed"},
      {"power_W", "radiated power", power, "W"},
      {"power_erg_per_s", "radiated power in erg/s", erg, "erg/s"},
      {"moment_of_inertia", "moment of inertia about the axis", r.moment ? Value(*r.moment) : Value(),
       si ? "kg m^2" : "density * length^5, in the mesh's length unit"},
      {"energy_J", "energy of rotation", of_spin(&SpinDown::energy), "J"},
      {"timescale_s", "timescale, energy over power", lasts ? of_spin(&SpinDown::timescale) : Value(), "s"},
      {"timescale_yr", "timescale in years", lasts ? Value(double(r.spin->timescale / julian_year)) : Value(), "yr"},
      {"time_s", "time since the start", r.time, "s"},
      {"deficit", "1 - omega/omega at the start", of_spin(&SpinDown::deficit)},
      {"omega_after", "omega at the end of that time", r.spin ? Value(r.spin->omega) : Value(), "rad/s"},
  };
  // A note says why what is not known is not.
  for (Finding& row : found.rows) row.missing = r.spin && row.key == "timescale_s" ? "never: nothing is radiated" : "";
  add_octupole(r, found);
  return found;
}

} // namespace cowgpu
