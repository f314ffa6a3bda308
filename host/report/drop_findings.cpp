#include "host/report/drop_findings.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace cowgpu {

using namespace physics;

namespace {

constexpr long double degree = std::numbers::pi_v<long double> / 180;

std::string touching_part(const DropOutcome& d) {
  const double angle = std::atan2(d.touch.cross(d.feet).norm(), d.touch.dot(d.feet)) / double(degree);
  return angle <= 60 ? "the end of the feet" : angle >= 120 ? "the end away from the feet" : "a side";
}

void add_notes(const DropOutcome& d, std::vector<std::string>& notes) {
  notes.push_back(
      "the earth is a point mass of its nominal GM under a ground of radius 6371 km; no air; at the start the "
      "centre of mass is at rest in an inertial frame");
  notes.push_back(fmt::format("it lands on its feet where their direction is within {} degrees of down as it touches",
                              lands_within));
  if (d.fall.torque.norm() == 0) notes.push_back("gravity exerts no torque on this body in this attitude");
  if (d.body.radius > 0.01 * (physics::earth.radius + d.height))
    notes.push_back("the body is not small beside the earth, which is taken to be at rest");
}

} // namespace

Findings findings(const DropOutcome& d) {
  Findings found(d.subject);
  const DropResult& r = d.fall;
  add_notes(d, found.notes);
  const bool spins = d.spin.norm() > 0;
  const auto vector = [](const LongVec3& v) { return Value(Vec3(v.cast<double>())); };
  const double half_turn = std::numbers::pi / double(r.time), time = double(r.time);
  const double first = double(r.first_order.norm()), turn = double(r.turn.norm());
  found.rows = {
      {"lands_on_its_feet", "lands on its feet", d.lands_on_its_feet()},
      {"feet_tilt_before_deg", "angle of the feet from down, dropped", d.tilt_before, "degrees"},
      {"feet_tilt_after_deg", "angle of the feet from down, touching", d.tilt_after, "degrees"},
      {"touches_with", "part that touches first", touching_part(d)},
      {"touch_point", "point that touches, body's axes", d.touch, "m"},
      {"touch_count", "number of corners as low", double(r.as_low)},
      {"turn_rad", "turn by gravity", turn, "rad"},
      {"turn_deg", "turn by gravity in degrees", double(r.turn.norm() / degree), "degrees"},
      {"turn_axis", "axis of the turn (x, up, z)", turn > 0 ? vector(LongVec3(r.turn.normalized())) : Value(), "", ""},
      {"turn_first_order_rad", "turn by torque t^2/2", spins ? Value() : Value(first), "rad", ""},
      {"turn_first_order_difference", "relative difference of that turn",
       !spins && first > 0 ? Value(double((r.turn - r.first_order).norm() / r.first_order.norm())) : Value(), "", ""},
      {"torque_N_m", "torque at the start, body's axes", vector(r.torque), "N m"},
      {"spin_rad_per_s", "spin at the start, body's axes", d.spin, "rad/s"},
      {"mass_kg", "mass", d.body.mass, "kg"},
      {"height_m", "height of the centre of mass", d.height, "m"},
      {"depth_m", "lowest point under the centre of mass", r.depth, "m"},
      {"fallen_m", "distance fallen", double(r.fallen), "m"},
      {"time_s", "time of the fall", time, "s"},
      {"time_kepler_s", "time of a point's fall (closed form)", double(r.kepler_time), "s"},
      {"speed_m_per_s", "speed as it touches", r.speed, "m/s"},
      {"spin_for_half_turn_rad_per_s", "spin that turns by 180 degrees", half_turn, "rad/s"},
      {"spin_for_half_turn_rpm", "spin that turns by 180 degrees, in rpm", half_turn * 30 / std::numbers::pi, "rpm"},
      {"spin_for_feet_rad_per_s", "spin that brings the feet down", double(d.tilt_before * degree) / time, "rad/s"},
      {"order", "highest degree", double(d.body.order)},
      {"energy_drift", "energy error, of that of motion", double(r.energy_drift)},
      {"momentum_drift", "angular momentum error", double(r.momentum_drift),
       "of what gravity gives a body of this size"}};
  return found;
}

} // namespace cowgpu
