#include "host/cli/physics.hpp"
#include "host/cli/quantities.hpp"

#include "host/error.hpp"
#include "host/physics/tides.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace cowgpu::cli {
namespace {

using namespace physics;

constexpr double degree = std::numbers::pi / 180;
constexpr int default_order = 6;
constexpr const char* principal_names[] = {"A", "B", "C"};

struct Options {
  std::string orbit, mass = "earth", attitude = "aligned", spin;
  std::optional<double> love, quality;
  int order = 0; // 0: not given
};

// Principal axes (least moment first) along x, y, z of the orbit frame.
LongMat3 aligned(const PrincipalAxes& principal) {
  const LongMat3 axes = principal.axes.cast<long double>();
  return axes.transpose() * (3 * LongMat3::Identity() - axes * axes.transpose()) / 2;
}

Value period(double rate) {
  return rate > 0 ? Value(2 * std::numbers::pi / rate) : Value();
}

struct Tides {
  PlacedTensors placed;
  MassiveBody body;
  PrincipalAxes principal;
  PointMass centre;
  Orbit orbit;
};

int order_of(const PhysicsInput& input, const PlacedTensors& placed, int asked, std::vector<std::string>& notes) {
  if (asked > 0 || input.body) return asked > 0 ? asked : default_order;
  const bool off = placed.tensors.first_moment.norm() > 1e-6 * placed.tensors.mass * placed.tensors.radius;
  const int order = off ? 2 : std::min(default_order, input.coefficients->lmax);
  if (order < default_order)
    notes.push_back(off ? "the coefficients are not about the centre of mass: only degree 2, which can be moved there"
                        : fmt::format("the coefficients end at degree {}", order));
  return order;
}

Table equilibria_table(const Tides& t) {
  Table table{
      "equilibria",
      "attitudes at rest under degree 2 (four each, by half turns); periods of small motions about them, which may "
      "grow where it is unstable (-: does not oscillate)",
      {{"outwards"},
       {"along"},
       {"normal"},
       {"stability"},
       {"pitch_period", "s"},
       {"roll_yaw_slow_period", "s"},
       {"roll_yaw_fast_period", "s"}},
      {}};
  for (const Libration& found : relative_equilibria(t.principal, t.orbit)) {
    const auto axis = [&](std::size_t i) { return Value(std::string(principal_names[found.axes[i]])); };
    table.rows.push_back({axis(0), axis(1), axis(2), Value(std::string(name(found.stability))), period(found.pitch),
                          period(found.roll_yaw[0]), period(found.roll_yaw[1])});
  }
  return table;
}

Table shift_table(const Tides& t) {
  Table table{"shifts",
              fmt::format("how far degrees 3 to {} turn the stable attitudes", t.body.order),
              {{"outwards"},
               {"normal"},
               {"about_outwards", "rad"},
               {"about_motion", "rad"},
               {"about_normal", "rad"},
               {"angle", "rad"}},
              {}};
  const LongMat3 start = aligned(t.principal);
  for (const int out : {1, -1})
    for (const int up : {1, -1}) {
      const LongVec3 half(out, out * up, up);
      const ShiftedEquilibrium found = shifted_equilibrium(t.body, t.orbit, LongMat3(half.asDiagonal()) * start);
      std::vector<Value> row = {Value(std::string(out > 0 ? "+A" : "-A")), Value(std::string(up > 0 ? "+C" : "-C"))};
      for (int i = 0; i < 3; ++i) row.push_back(found.found ? Value(double(found.shift[i])) : Value());
      row.push_back(found.found ? Value(double(found.shift.norm())) : Value());
      table.rows.push_back(row);
    }
  return table;
}

void add_locking(const Tides& t, const Options& options, Findings& found) {
  const double spin =
      options.spin.empty() ? 0 : parse_positive("--spin", options.spin, Dimension::angular_rate, "1rad/s");
  if (spin > 0 && !is_isotropic(t.principal)) {
    const double half = capture_half_width(t.principal, t.orbit);
    found.rows.push_back({"caught", "a body with this spin about C is caught", std::abs(spin - t.orbit.rate) < half});
  }
  if (!options.love && !options.quality) return;
  if (!options.love || !options.quality || options.spin.empty())
    throw Error(Fault::bad_argument, "the time to lock needs all of --love, --quality and --spin");
  const double time = locking_time(t.body, t.orbit, spin, *options.love, *options.quality);
  found.rows.push_back({"locking_time_s", "time to lock by tides", time, "s"});
  found.rows.push_back({"locking_time_yr", "time to lock by tides, in years", time / julian_year, "yr"});
  found.notes.push_back(
      "time to lock: omega r^6 I Q/(3 G M^2 k2 R^5), Gladman et al. 1996, with I and R of the uniform ball "
      "of the body's mass and second moment");
}

void add_attitude(const Tides& t, const Options& options, Findings& found) {
  const LongMat3 attitude = options.attitude == "aligned" ? aligned(t.principal)
                            : options.attitude == "as-is" ? LongMat3(LongMat3::Identity())
                                                          : parse_turn("--attitude", options.attitude);
  MassiveBody quadrupole = t.body;
  quadrupole.higher.reset();
  const OrbitTorque all = orbit_torque(t.body, t.orbit, attitude), second = orbit_torque(quadrupole, t.orbit, attitude);
  const auto vector = [](const LongVec3& v) { return Value(Vec3(v.cast<double>())); };
  found.rows.push_back({"attitude", "attitude, body's axes to the orbit's", Eigen::Matrix3d(attitude.cast<double>())});
  found.rows.push_back({"torque", "gravity's torque (out, along, normal)", vector(all.gravity), "N m"});
  found.rows.push_back({"torque_quadrupole", "torque of degree 2", vector(second.gravity), "N m"});
  found.rows.push_back({"torque_higher", fmt::format("torque of degrees 3 to {}", t.body.order),
                        vector(LongVec3(all.gravity - second.gravity)), "N m"});
  found.rows.push_back({"torque_at_rest", "torque left in the orbit's frame", vector(all.rest), "N m"});
}

Tides read_tides(const PhysicsInput& input, const PhysicsOptions& common, const Options& options, Findings& found) {
  Tides t;
  t.centre = parse_point_mass("--mass", options.mass);
  const double radius = parse_positive("--orbit", options.orbit, Dimension::length, "6771km");
  note_unit("--orbit", options.orbit, Dimension::length, found.notes);
  t.placed = metric_tensors(input, common);
  t.body = massive_body(input, t.placed, order_of(input, t.placed, options.order, found.notes));
  t.principal = principal_axes(about_centre(t.placed.tensors));
  t.orbit = circular_orbit(t.centre, t.body, radius);
  // Farther out the sphere of no body that the coefficients describe is in question.
  if (const std::string note = unknown_radius_note(input); !note.empty() && radius < 10 * t.body.radius)
    found.notes.push_back(note);
  if (radius < t.centre.radius)
    found.notes.push_back(fmt::format(
        "an orbit of this radius runs inside the {}, whose radius is {:g} km and which is taken for a point",
        t.centre.name, t.centre.radius / 1e3));
  return t;
}

Findings solve(const PhysicsOptions& common, const Options& options) {
  const PhysicsInput input = load_free_body(common);
  Findings found = findings_about(input, common);
  const Tides t = read_tides(input, common, options, found);
  const bool isotropic = is_isotropic(t.principal);
  const Libration stable = libration(t.principal, t.orbit, {0, 1, 2});
  const auto librates = [&](double rate) { return isotropic ? Value() : period(rate); };
  found.notes.push_back(
      "orbit frame: x outwards from the point mass, y along the motion, z along the orbit's normal; A, B "
      "and C are the principal axes by growing moment of inertia");
  if (isotropic)
    found.notes.push_back(
        "all three moments of inertia are equal: degree 2 exerts no torque on this body, no attitude is better "
        "than another and nothing librates or locks");
  else if (t.principal.first_two_alike || t.principal.last_two_alike)
    found.notes.push_back("two moments of inertia are equal: about the axis of symmetry the body turns freely");
  found.rows = {{"mass_kg", "mass", t.body.mass, "kg"},
                {"centre", "centre of the orbit",
                 t.centre.name.empty() ? Value(std::string("a point mass")) : Value(t.centre.name)},
                {"centre_mass_kg", "mass of the centre", t.centre.mass(), "kg"},
                {"radius_m", "radius of the orbit", t.orbit.radius, "m"},
                {"order", "highest degree", double(t.body.order)},
                {"rate_rad_per_s", "orbital rate n", t.orbit.rate, "rad/s"},
                {"period_s", "orbital period", 2 * std::numbers::pi / t.orbit.rate, "s"},
                {"principal_moments", "moments of inertia A, B, C", *t.principal.moments, "kg m^2"},
                {"principal_axes", "principal axes, one a row", Eigen::Matrix3d(t.principal.axes.transpose())}};
  add_attitude(t, options, found);
  found.rows.push_back({"largest_torque", "largest torque, 3 GM (C - A)/(2 r^3)",
                        largest_quadrupole_torque(t.principal, t.orbit), "N m"});
  found.rows.push_back({"librates", "body librates", !isotropic});
  found.rows.push_back({"pitch_period_s", "libration period, pitch", librates(stable.pitch), "s"});
  found.rows.push_back(
      {"roll_yaw_slow_period_s", "libration period, roll and yaw, slow", librates(stable.roll_yaw[0]), "s"});
  found.rows.push_back(
      {"roll_yaw_fast_period_s", "libration period, roll and yaw, fast", librates(stable.roll_yaw[1]), "s"});
  const double half = isotropic ? 0 : capture_half_width(t.principal, t.orbit);
  found.rows.push_back({"capture_half_width_rad_per_s", "largest |spin - n| caught", half, "rad/s"});
  found.rows.push_back({"capture_fraction", "largest |spin - n| caught, over n", half / t.orbit.rate});
  add_locking(t, options, found);
  if (isotropic) return found;
  found.tables.push_back(equilibria_table(t));
  if (t.body.order > 2) found.tables.push_back(shift_table(t));
  return found;
}

} // namespace

Solve add_tides(Command& command, Common&) {
  const auto options = std::make_shared<Options>();
  command
      .add_option("--orbit", options->orbit,
                  "Radius of the circular orbit: 6771km, 1.1R_earth (R_earth is 6371 km, the earth's mean radius), 1au")
      ->type_name("RADIUS")
      ->required();
  command
      .add_option("--mass", options->mass,
                  "Mass at the centre of the orbit, a point: earth, moon, sun, or a mass: 6e24kg")
      ->type_name("MASS")
      ->capture_default_str();
  command
      .add_option(
          "--attitude", options->attitude,
          "For the torque: aligned (A outwards, C along the normal), as-is (the mesh's axes along the orbit's), or a "
          "turn from as-is: AXIS:DEGREES, or ALPHA,BETA,GAMMA as --rotate has it")
      ->type_name("TURN")
      ->capture_default_str();
  command
      .add_option("--order", options->order, fmt::format("Highest degree of the multipoles; default {}", default_order))
      ->type_name("L")
      ->check(in_range(2, 64));
  command.add_option("--spin", options->spin, "How fast it spins at first, about C: whether it is caught")
      ->type_name("RATE");
  command
      .add_option("--love", options->love,
                  fmt::format("Love number k2 of the body, above 0 to {}: with --quality and --spin the time to lock",
                              largest_love))
      ->type_name("NUMBER");
  command
      .add_option("--quality", options->quality,
                  fmt::format("Quality factor Q of the body, 1 to {:.0e}", largest_quality))
      ->type_name("NUMBER");
  return [options](const PhysicsOptions& common) { return solve(common, *options); };
}

} // namespace cowgpu::cli
