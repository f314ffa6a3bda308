#include "host/report/tides_findings.hpp"

#include "host/units.hpp"

#include <fmt/format.h>

#include <numbers>

namespace cowgpu {

using namespace physics;

namespace {

constexpr const char* principal_names[] = {"A", "B", "C"};

Value period(double rate) {
  return rate > 0 ? Value(2 * std::numbers::pi / rate) : Value();
}

Table equilibria_table(const TidesResult& t) {
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
  for (const Libration& found : t.equilibria) {
    const auto axis = [&](std::size_t i) { return Value(std::string(principal_names[found.axes[i]])); };
    table.rows.push_back({axis(0), axis(1), axis(2), Value(std::string(name(found.stability))), period(found.pitch),
                          period(found.roll_yaw[0]), period(found.roll_yaw[1])});
  }
  return table;
}

Table shift_table(const TidesResult& t) {
  Table table{"shifts",
              fmt::format("how far degrees 3 to {} turn the stable attitudes", t.body.order),
              {{"outwards"},
               {"normal"},
               {"about_outwards", "rad"},
               {"about_motion", "rad"},
               {"about_normal", "rad"},
               {"angle", "rad"}},
              {}};
  for (const auto& [outwards, normal, found] : t.shifts) {
    std::vector<Value> row = {Value(std::string(outwards > 0 ? "+A" : "-A")),
                              Value(std::string(normal > 0 ? "+C" : "-C"))};
    if (found.found)
      row.insert(row.end(),
                 {double(found.shift[0]), double(found.shift[1]), double(found.shift[2]), double(found.shift.norm())});
    row.resize(table.columns.size());
    table.rows.push_back(row);
  }
  return table;
}

void add_attitude(const TidesResult& t, Findings& found) {
  const auto vector = [](const LongVec3& v) { return Value(Vec3(v.cast<double>())); };
  found.rows.push_back(
      {"attitude", "attitude, body's axes to the orbit's", Eigen::Matrix3d(t.attitude.cast<double>())});
  found.rows.push_back({"torque", "gravity's torque (out, along, normal)", vector(t.torque.gravity), "N m"});
  found.rows.push_back({"torque_quadrupole", "torque of degree 2", vector(t.torque_quadrupole.gravity), "N m"});
  found.rows.push_back({"torque_higher", fmt::format("torque of degrees 3 to {}", t.body.order),
                        vector(LongVec3(t.torque.gravity - t.torque_quadrupole.gravity)), "N m"});
  found.rows.push_back({"torque_at_rest", "torque left in the orbit's frame", vector(t.torque.rest), "N m"});
}

void add_locking(const TidesResult& t, Findings& found) {
  if (t.caught) found.rows.push_back({"caught", "a body with this spin about C is caught", *t.caught});
  if (!t.locking_time) return;
  found.rows.push_back({"locking_time_s", "time to lock by tides", *t.locking_time, "s"});
  found.rows.push_back({"locking_time_yr", "time to lock by tides, in years", *t.locking_time / julian_year, "yr"});
  found.notes.push_back(
      "time to lock: omega r^6 I Q/(3 G M^2 k2 R^5), Gladman et al. 1996, with I and R of the uniform ball "
      "of the body's mass and second moment");
}

} // namespace

Findings findings(const TidesResult& t) {
  Findings found(t.subject);
  const auto librates = [&](double rate) { return t.isotropic ? Value() : period(rate); };
  found.notes.push_back(
      "orbit frame: x outwards from the point mass, y along the motion, z along the orbit's normal; A, B "
      "and C are the principal axes by growing moment of inertia");
  if (t.isotropic)
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
  add_attitude(t, found);
  found.rows.push_back({"largest_torque", "largest torque, 3 GM (C - A)/(2 r^3)", t.largest_torque, "N m"});
  found.rows.push_back({"librates", "body librates", !t.isotropic});
  found.rows.push_back({"pitch_period_s", "libration period, pitch", librates(t.stable.pitch), "s"});
  found.rows.push_back(
      {"roll_yaw_slow_period_s", "libration period, roll and yaw, slow", librates(t.stable.roll_yaw[0]), "s"});
  found.rows.push_back(
      {"roll_yaw_fast_period_s", "libration period, roll and yaw, fast", librates(t.stable.roll_yaw[1]), "s"});
  found.rows.push_back({"capture_half_width_rad_per_s", "largest |spin - n| caught", t.capture_half_width, "rad/s"});
  found.rows.push_back({"capture_fraction", "largest |spin - n| caught, over n", t.capture_half_width / t.orbit.rate});
  add_locking(t, found);
  if (!t.equilibria.empty()) found.tables.push_back(equilibria_table(t));
  if (!t.shifts.empty()) found.tables.push_back(shift_table(t));
  return found;
}

} // namespace cowgpu
