#include "host/cli/physics.hpp"
#include "host/cli/quantities.hpp"

#include "host/error.hpp"
#include "host/physics/paper.hpp"
#include "host/physics/radiate.hpp"
#include "host/spectrum/mass_moments.hpp"
#include "host/units.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace cowgpu::cli {
namespace {

using namespace physics;

struct Options {
  std::string axis = "y", omega, period, start = "12Myr", age = "13.787Gyr";
  bool octupole = false;
};

// A body that turns slower has not turned once in 400 Gyr.
constexpr double slowest = 5e-19;

double check_rate(double omega, const char* option, const std::string& text) {
  if (!(omega >= slowest))
    throw Error(Fault::bad_argument,
                fmt::format("{} {}: {:.3g} rad/s is slower than a turn in 400 Gyr, {} rad/s, which is as slow as this "
                            "goes",
                            option, text, omega, slowest));
  return omega;
}

double parse_omega(const Options& options, std::vector<std::string>& notes) {
  if (!options.period.empty()) {
    if (!options.omega.empty())
      throw Error(Fault::bad_argument, "--omega and --period both say how fast the body turns; leave one out");
    const double period = parse_quantity("--period", options.period, Dimension::time, "24h").value;
    if (!(period > 0)) throw Error(Fault::bad_argument, fmt::format("--period {}: it must be above 0", options.period));
    return check_rate(2 * std::numbers::pi / period, "--period", options.period);
  }
  const std::string text = options.omega.empty() ? "1rad/s" : options.omega;
  const Measure omega = parse_quantity("--omega", text, Dimension::angular_rate, "1rad/s, 3rpm or 1Hz");
  if (!(omega.value > 0))
    throw Error(Fault::bad_argument, fmt::format("--omega {}: it must be above 0; turn --axis round for the other "
                                                 "sense, which radiates the same",
                                                 text));
  if (omega.unit == "Hz" || omega.unit == "/s")
    notes.push_back(fmt::format("{} is read as an angular frequency, 1 Hz being 1 rad/s, as the paper has it; --period "
                                "1s is one turn a second",
                                text));
  return check_rate(omega.value, "--omega", text);
}

double parse_time(const Options& options) {
  const double start = parse_quantity("--start", options.start, Dimension::time, "12Myr").value;
  const double age = parse_quantity("--age", options.age, Dimension::time, "13.787Gyr").value;
  if (!(start >= 0) || !(age >= start))
    throw Error(Fault::bad_argument,
                fmt::format("--start {} --age {}: both count from the Big Bang, and the start comes "
                            "first",
                            options.start, options.age));
  return age - start;
}

struct Radiation {
  MassTensors tensors; // about the centre of mass
  Vec3 axis;
  double omega = 0, time = 0;
  double square = 0; // in the tensors' unit
  std::optional<double> octupole, current_quadrupole;
  std::optional<double> moment, agreement;
  std::optional<double> unit_m, unit_kg;
  std::optional<SpinDown> spin;
  long double power = 0;
};

// The spherical formula, of multipoles that no Cartesian tensor went into.
double by_multipoles(const PhysicsInput& input, const MassTensors& tensors, const Vec3& axis) {
  if (!input.body) return quadrupole_square(spherical_quadrupole(tensors.quadrupole), axis);
  Monitor monitor;
  const Multipoles q = mass_moments(mass_problems(*input.body, 2, 0), *make_cpu_backend(1), monitor);
  const double r2 = q.reference_radius * q.reference_radius;
  return quadrupole_square(std::array{r2 * q(2, 0), r2 * q(2, 1), r2 * q(2, 2)}, axis);
}

void check_speed(const Radiation& r, std::vector<std::string>& notes) {
  // Of a body whose sphere is not known some matter is at least as far from the axis as the radius of gyration.
  const bool known = r.tensors.radius_known;
  const double radius = known ? r.tensors.radius : r.moment ? std::sqrt(*r.moment / r.tensors.mass) : 0;
  const double speed = r.omega * radius;
  if (speed >= speed_of_light_si)
    throw Error(Fault::bad_argument,
                fmt::format("at {} rad/s a body of {} m moves at {:.3g} m/s, faster than light: lower "
                            "--omega",
                            r.omega, radius, speed));
  if (speed >= 0.1 * speed_of_light_si)
    notes.push_back(fmt::format("the body moves at {:.2g} of the speed of light, and the formula is for slow ones",
                                speed / speed_of_light_si));
  else if (!known && r.omega * r.tensors.radius >= 0.1 * speed_of_light_si)
    notes.push_back(fmt::format("the file does not say how large its body is; if it reaches its reference radius of "
                                "{:.6g} m, it moves at {:.2g} of the speed of light, and the formula is for slow ones; "
                                "--brillouin-radius states how large it is",
                                r.tensors.radius, r.omega * r.tensors.radius / speed_of_light_si));
}

void check_wobble(const Eigen::Matrix3d& inertia, const Vec3& axis, std::vector<std::string>& notes) {
  const Vec3 spin = inertia * axis;
  const double angle = std::atan2(spin.cross(axis).norm(), spin.dot(axis)) * 180 / std::numbers::pi;
  if (angle > 1e-6)
    notes.push_back(
        fmt::format("the axis is not a principal axis: the angular momentum is {:.3g} degrees off it, and the body "
                    "turns about it only where it is held",
                    angle));
}

void check_mass(const MassTensors& tensors, const Vec3& axis) {
  const char* mass_unit = tensors.metric() ? " kg" : "";
  const char* moment_unit = tensors.metric() ? " kg m^2" : "";
  if (!(tensors.mass > 0))
    throw Error(Fault::bad_argument, fmt::format("the body weighs {:.6g}{}: only one with a mass above 0 spins down; "
                                                 "change --density or the density of a --part",
                                                 tensors.mass, mass_unit));
  if (!tensors.trace) return;
  if (const double moment = axis.dot(tensors.inertia() * axis); !(moment > 0))
    throw Error(Fault::bad_argument,
                fmt::format("the body weighs {:.6g}{}, but its moment of inertia about the axis is {:.6g}{}: only one "
                            "with both above 0 spins down; change --density or the density of a --part",
                            tensors.mass, mass_unit, moment, moment_unit));
}

Radiation radiation(const PhysicsInput& input, const PhysicsOptions& common, const Options& options,
                    std::vector<std::string>& notes) {
  Radiation r;
  r.axis = parse_axis("--axis", options.axis);
  r.omega = parse_omega(options, notes);
  r.time = parse_time(options);
  const PlacedTensors placed = placed_tensors(input, common);
  r.tensors = about_centre(placed.tensors);
  check_mass(r.tensors, r.axis);
  r.unit_m = placed.unit_m;
  r.unit_kg = placed.unit_kg;
  r.square = quadrupole_square(r.tensors.quadrupole, r.axis);
  const double scale = r.tensors.quadrupole.squaredNorm(), size = r.tensors.trace.value_or(0);
  const double largest = std::max(scale, size * size);
  if ((size > 0 || !r.tensors.quadrupole.isZero(0)) && !std::isnormal(largest))
    throw Error(Fault::bad_argument,
                "the body is too small or too large for the squares of its tensors to be computed: "
                "give another unit of length, or another density");
  r.agreement =
      std::abs(by_multipoles(input, r.tensors, r.axis) - r.square) / std::max(64 * scale, 1e-12 * size * size);
  if (r.square <= 1e-26 * largest) {
    r.square = 0;
    notes.push_back("turned about this axis the quadrupole stays as it is, but for rounding: it radiates nothing");
  }
  if (options.octupole) {
    if (!input.body)
      throw Error(Fault::file_format,
                  "--octupole: the current quadrupole needs the integral of density r^2 x, which no "
                  "file of multipoles holds; take the mesh");
    const Tensor3 third = third_moment(*input.body);
    r.octupole = octupole_square(third, r.axis);
    r.current_quadrupole = current_quadrupole_square(third, r.axis);
  }
  if (r.tensors.trace) {
    r.moment = r.axis.dot(r.tensors.inertia() * r.axis);
    check_wobble(r.tensors.inertia(), r.axis, notes);
  } else {
    notes.push_back("the file does not say the second moment: no energy and no time without it; the JSON of "
                    "`cowgpu expand` holds it");
  }
  if (!r.tensors.metric()) {
    notes.push_back("no unit was stated: --length 2.5m (or --length-unit) and --density 1g/cm3 give watts and seconds");
    return r;
  }
  check_speed(r, notes);
  r.power = quadrupole_power(r.square, r.omega);
  if (r.square > 0 && !std::isnormal(double(r.power)))
    throw Error(Fault::bad_argument,
                fmt::format("at {:.3g} rad/s this body radiates {:.3g} W, which doubles cannot hold: give "
                            "another --omega or --period, or another unit of length",
                            r.omega, r.power));
  if (r.moment) r.spin = spin_down(*r.moment, r.power, r.omega, r.time);
  return r;
}

Value value(const std::optional<double>& number) {
  return number ? Value(*number) : Value();
}

// In the mesh's unit and density, as the paper has it.
double in_mesh_units(const Radiation& r, double square) {
  const double unit = r.unit_kg.value_or(1) * r.unit_m.value_or(1) * r.unit_m.value_or(1);
  return square / (unit * unit);
}

void add_octupole(const Radiation& r, Findings& found) {
  if (!r.octupole) return;
  found.notes.push_back(
      "octupole and current quadrupole are of the order (omega R/c)^2 beside the quadrupole, as is its "
      "own relativistic correction, which is not among them");
  const double length = r.unit_m.value_or(1);
  const char* unit = "(unit of mass * length^3)^2";
  found.rows.push_back({"octupole_square_over_omega8", "mass octupole I''''^2 / omega^8",
                        in_mesh_units(r, *r.octupole) / (length * length), unit});
  found.rows.push_back({"current_quadrupole_square_over_omega8", "current quadrupole J'''^2 / omega^8",
                        in_mesh_units(r, *r.current_quadrupole) / (length * length), unit});
  if (!r.tensors.metric()) return;
  found.rows.push_back(
      {"octupole_power_W", "power of the mass octupole", double(octupole_power(*r.octupole, r.omega)), "W"});
  found.rows.push_back({"current_quadrupole_power_W", "power of the current quadrupole",
                        double(current_quadrupole_power(*r.current_quadrupole, r.omega)), "W"});
}

std::vector<Comparison> beside_paper(const Radiation& r, const Body& body) {
  const std::string sampled = "from the paper's tensors, which are up to 2 % off";
  const double square_si = r.square, erg = double(r.power) * 1e7, year = 365 * 86400.0;
  const double box_length = bounding_box(body.surface.vertices(), body.surface.faces()).longest_side();
  const double length_unit = paper::length / (box_length / body.placement.scale);
  const double rounded = (13.787e9 - 12e6) * year / (2 * paper::timescale_s);
  return {
      {"length unit in m", length_unit, paper::length_unit_m,
       "2.5 m over the mesh's own length, 1.044392, is 2.39374 m, cut to three digits; the power grows like its tenth "
       "power, +1.57 %"},
      {"mass unit in kg", *r.unit_kg, paper::mass_unit_kg},
      {"volume", r.tensors.mass / *r.unit_kg, paper::volume, "0.05348 rounds to 0.053"},
      {"mass in kg", r.tensors.mass, paper::mass_kg, "of the volume 0.054"},
      {"Q'''^2/omega^6", in_mesh_units(r, r.square), paper::square, sampled},
      {"Q'''^2/omega^6 in kg^2 m^4", square_si, paper::square_si, "9e12 is a misprint for 9e6: see the power"},
      {"power in erg/s", erg, paper::power_erg_per_s, sampled},
      {"factor of sum |Q'''_2m|^2 G/c^5", 8 * std::numbers::pi / 75, 3 / (8 * std::numbers::pi),
       "8 pi/75 goes with Q_2m as the paper defines it; 3/(8 pi) gives 2.807 times too little"},
      {"timescale in s", double(r.spin->timescale), paper::timescale_s, sampled},
      {"1 - omega now", double(r.spin->deficit), paper::deficit,
       "the paper rounds the timescale to 1.9e49 s and takes years of 365 days"},
      {"the same with its rounding", rounded, paper::deficit},
  };
}

// The paper turns its cow about y at 1 Hz, from 12 Myr to now.
Options paper_options(const Options& options) {
  const Options fresh;
  if (options.axis != fresh.axis || !options.omega.empty() || !options.period.empty() || options.start != fresh.start ||
      options.age != fresh.age)
    throw Error(Fault::bad_argument, "--recipe paper sets axis, spin and times as the paper has them: leave --axis, "
                                     "--omega, --period, --start and --age out");
  Options paper = options;
  paper.omega = "1Hz";
  return paper;
}

Findings solve(const PhysicsOptions& common, const Options& options) {
  const PhysicsInput input = load_free_body(common);
  Findings found = findings_about(input, common);
  const Radiation r = radiation(input, common, options, found.notes);
  const bool si = r.tensors.metric(), lasts = r.spin && std::isfinite(r.spin->timescale);
  const auto of_spin = [&](auto member) { return r.spin ? Value(double(*r.spin.*member)) : Value(); };
  const Value power = si ? Value(double(r.power)) : Value(), erg = si ? Value(double(r.power * 1e7L)) : Value();
  found.rows = {
      {"axis", "axis", r.axis},
      {"omega_rad_per_s", "angular frequency", r.omega, "rad/s"},
      {"length_unit_m", "unit of length", value(r.unit_m), "m"},
      {"mass_unit_kg", "unit of mass, density times its cube", value(r.unit_kg), "kg"},
      {"mass_kg", "mass", si ? Value(r.tensors.mass) : Value(), "kg"},
      {"qdddot2_over_omega6", "Q'''_ij Q'''_ij / omega^6", in_mesh_units(r, r.square), "(unit of mass * length^2)^2"},
      {"qdddot2_over_omega6_SI", "Q'''_ij Q'''_ij / omega^6, SI", si ? Value(r.square) : Value(), "kg^2 m^4"},
      {"spherical_difference", "difference from the spherical formula", value(r.agreement),
       "of 64 Q_ij Q_ij, which it cannot exceed"},
      {"power_W", "radiated power", power, "W"},
      {"power_erg_per_s", "radiated power in erg/s", erg, "erg/s"},
      {"moment_of_inertia", "moment of inertia about the axis", value(r.moment),
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
  if (common.paper() && r.spin) found.paper = beside_paper(r, *input.body);
  return found;
}

} // namespace

Solve add_radiate(Command& command, Common&) {
  const auto options = std::make_shared<Options>();
  command.add_option("--axis", options->axis, "Through the centre of mass: x, y, z or X,Y,Z in the body's axes")
      ->type_name("AXIS")
      ->capture_default_str();
  command
      .add_option(
          "--omega", options->omega,
          "Angular frequency with its unit: 90deg/s, 3rpm; 1Hz and 1/s are 1 rad/s, as in the paper; without this "
          "option 1rad/s")
      ->type_name("RATE");
  command.add_option("--period", options->period, "Time of one turn with its unit, such as 1s, instead of --omega")
      ->type_name("TIME");
  command.add_option("--start", options->start, "When it began to turn, after the Big Bang (Julian years)")
      ->type_name("TIME")
      ->capture_default_str();
  command.add_option("--age", options->age, "When the spin is asked for, after the Big Bang")
      ->type_name("TIME")
      ->capture_default_str();
  command.add_flag("--octupole", options->octupole,
                   "Also the mass octupole and the current quadrupole, from the mesh's exact third moments");
  return [options](const PhysicsOptions& common) {
    return solve(common, common.paper() ? paper_options(*options) : *options);
  };
}

} // namespace cowgpu::cli
