#include "host/cli/physics.hpp"
#include "host/cli/quantities.hpp"

#include "host/error.hpp"
#include "host/io/coefficient_content.hpp"
#include "host/physics/drop.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cowgpu::cli {
namespace {

using namespace physics;

constexpr long double degree = std::numbers::pi_v<long double> / 180;
constexpr double lands_within = 45;

struct Options {
  std::string height, attitude = "upright", feet = "-y", spin;
  int order = 6;
};

// The least turn that brings the feet down, about x where it is a half turn.
LongMat3 feet_down(const Vec3& feet) {
  if (feet == -Vec3::UnitY()) return LongMat3::Identity();
  if (feet == Vec3::UnitY()) return turn_about(Vec3::UnitX(), 180);
  return Eigen::Quaternion<long double>::FromTwoVectors(feet.cast<long double>(), -LongVec3::UnitY())
      .toRotationMatrix();
}

LongMat3 parse_attitude(const Options& options, const Vec3& feet) {
  if (options.attitude == "upright") return feet_down(feet);
  if (options.attitude == "upside-down") return turn_about(Vec3::UnitX(), 180) * feet_down(feet);
  if (options.attitude == "on-side") return turn_about(Vec3::UnitX(), 90) * feet_down(feet);
  try {
    return parse_turn("--attitude", options.attitude);
  } catch (const Error& error) {
    throw Error(error.fault(), fmt::format("{}; or upright, upside-down, on-side, or AXIS:DEGREES", error.what()));
  }
}

// AXIS,RATE with AXIS perhaps X,Y,Z.
Vec3 parse_spin(const std::string& text) {
  if (text.empty()) return Vec3::Zero();
  const std::size_t comma = text.rfind(',');
  if (comma == std::string::npos)
    throw Error(Fault::bad_argument, fmt::format("--spin {}: it takes AXIS,RATE, as in x,10rpm", text));
  return parse_axis("--spin", text.substr(0, comma)) *
         parse_quantity("--spin", text.substr(comma + 1), Dimension::angular_rate, "x,10rpm").value;
}

struct Drop {
  DropProblem problem;
  DropResult result;
  Vec3 feet, touch;
  double tilt_before = 0, tilt_after = 0, turn = 0;
};

double tilt(const LongMat3& attitude, const Vec3& feet) {
  const LongVec3 f = attitude * feet.cast<long double>();
  return double(std::atan2(std::hypot(f.x(), f.z()), -f.y()) / degree);
}

std::string touching_part(const Drop& d) {
  const double angle = std::atan2(d.touch.cross(d.feet).norm(), d.touch.dot(d.feet)) / double(degree);
  return angle <= 60 ? "the end of the feet" : angle >= 120 ? "the end away from the feet" : "a side";
}

std::vector<Vec3> corners_of(const ClosedSurface& surface) {
  std::vector<Vec3> corners;
  for (const Face& face : surface.faces())
    for (const std::uint32_t corner : face) corners.push_back(surface.vertices()[corner]);
  return corners;
}

Drop solve_drop(const PhysicsInput& input, const PhysicsOptions& common, const Options& options, ProgressStyle style) {
  Drop d;
  d.feet = parse_axis("--feet", options.feet);
  d.problem.height = parse_quantity("--height", options.height, Dimension::length, "10m").value;
  d.problem.attitude = parse_attitude(options, d.feet);
  d.problem.spin = parse_spin(options.spin);
  const PlacedTensors placed = metric_tensors(input, common);
  d.problem.body = massive_body(input, placed, options.order);
  std::vector<Vec3> vertices = corners_of(input.body->surface);
  for (const Part& part : input.body->parts) {
    const std::vector<Vec3> more = corners_of(part.surface);
    if (part.density > 0) vertices.insert(vertices.end(), more.begin(), more.end());
  }
  std::sort(vertices.begin(), vertices.end(), [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (Vec3& v : vertices) v -= input.body->centre_of_mass;
  d.problem.vertices = vertices;
  ConsoleMonitor monitor(style);
  d.result = drop(d.problem, monitor);
  d.touch = vertices[d.result.touching];
  d.problem.vertices = {};
  d.tilt_before = tilt(d.problem.attitude, d.feet);
  d.tilt_after = tilt(d.result.attitude, d.feet);
  d.turn = double(d.result.turn.norm());
  return d;
}

void add_notes(const Drop& d, std::vector<std::string>& notes) {
  notes.push_back(
      "the earth is a point mass of its nominal GM under a ground of radius 6371 km; no air; at the start the "
      "centre of mass is at rest in an inertial frame");
  notes.push_back(fmt::format("it lands on its feet where their direction is within {} degrees of down as it touches",
                              lands_within));
  if (d.result.torque.norm() == 0) notes.push_back("gravity exerts no torque on this body in this attitude");
  if (d.problem.body.radius > 0.01 * (d.problem.planet.radius + d.problem.height))
    notes.push_back("the body is not small beside the earth, which is taken to be at rest");
}

Findings solve(const PhysicsOptions& common, const Options& options, ProgressStyle style) {
  if (is_coefficient_file(common.body.mesh))
    throw Error(
        Fault::file_format,
        fmt::format("{} holds coefficients, which do not say where the body's lowest point is; `drop` needs the mesh",
                    common.body.mesh));
  const PhysicsInput input = load_free_body(common);
  Findings found = findings_about(input, common);
  const Drop d = solve_drop(input, common, options, style);
  const DropResult& r = d.result;
  add_notes(d, found.notes);
  const bool spins = d.problem.spin.norm() > 0;
  const auto vector = [](const LongVec3& v) { return Value(Vec3(v.cast<double>())); };
  const double half_turn = std::numbers::pi / double(r.time), time = double(r.time);
  const double first = double(r.first_order.norm());
  found.rows = {
      {"lands_on_its_feet", "lands on its feet", d.tilt_after <= lands_within},
      {"feet_tilt_before_deg", "angle of the feet from down, dropped", d.tilt_before, "degrees"},
      {"feet_tilt_after_deg", "angle of the feet from down, touching", d.tilt_after, "degrees"},
      {"touches_with", "part that touches first", touching_part(d)},
      {"touch_point", "point that touches, body's axes", d.touch, "m"},
      {"touch_count", "number of corners as low", double(r.as_low)},
      {"turn_rad", "turn by gravity", d.turn, "rad"},
      {"turn_deg", "turn by gravity in degrees", double(r.turn.norm() / degree), "degrees"},
      {"turn_axis", "axis of the turn (x, up, z)", d.turn > 0 ? vector(LongVec3(r.turn.normalized())) : Value(), "",
       ""},
      {"turn_first_order_rad", "turn by torque t^2/2", spins ? Value() : Value(first), "rad", ""},
      {"turn_first_order_difference", "relative difference of that turn",
       !spins && first > 0 ? Value(double((r.turn - r.first_order).norm() / r.first_order.norm())) : Value(), "", ""},
      {"torque_N_m", "torque at the start, body's axes", vector(r.torque), "N m"},
      {"spin_rad_per_s", "spin at the start, body's axes", d.problem.spin, "rad/s"},
      {"mass_kg", "mass", d.problem.body.mass, "kg"},
      {"height_m", "height of the centre of mass", d.problem.height, "m"},
      {"depth_m", "lowest point under the centre of mass", r.depth, "m"},
      {"fallen_m", "distance fallen", double(r.fallen), "m"},
      {"time_s", "time of the fall", time, "s"},
      {"time_kepler_s", "time of a point's fall (closed form)", double(r.kepler_time), "s"},
      {"speed_m_per_s", "speed as it touches", r.speed, "m/s"},
      {"spin_for_half_turn_rad_per_s", "spin that turns by 180 degrees", half_turn, "rad/s"},
      {"spin_for_half_turn_rpm", "spin that turns by 180 degrees, in rpm", half_turn * 30 / std::numbers::pi, "rpm"},
      {"spin_for_feet_rad_per_s", "spin that brings the feet down", double(d.tilt_before * degree) / time, "rad/s"},
      {"order", "highest degree", double(d.problem.body.order)},
      {"energy_drift", "energy error, of that of motion", double(r.energy_drift)},
      {"momentum_drift", "angular momentum error", double(r.momentum_drift),
       "of what gravity gives a body of this size"}};
  return found;
}

} // namespace

Solve add_drop(Command& command, Common& program) {
  const auto options = std::make_shared<Options>();
  command.add_option("--height", options->height, "Height of the centre of mass above the ground, with its unit: 10m")
      ->type_name("LENGTH")
      ->required();
  command
      .add_option("--attitude", options->attitude,
                  "upright (feet down), upside-down, on-side (a half and a quarter turn about x), or a turn of the "
                  "mesh's axes, "
                  "of which y is up: AXIS:DEGREES, or ALPHA,BETA,GAMMA as --rotate has it")
      ->type_name("TURN")
      ->capture_default_str();
  command.add_option("--feet", options->feet, "Where the feet are, in the body's axes: x, -y, X,Y,Z ...")
      ->type_name("AXIS")
      ->capture_default_str();
  command.add_option("--spin", options->spin, "Spin at the start, about an axis of the body: x,10rpm or 1,2,0,3rad/s")
      ->type_name("AXIS,RATE");
  command.add_option("--order", options->order, "Highest degree of the multipoles")
      ->type_name("L")
      ->check(in_range(2, 64))
      ->capture_default_str();
  return [options, &program](const PhysicsOptions& common) { return solve(common, *options, program.style()); };
}

} // namespace cowgpu::cli
