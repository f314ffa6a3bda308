#include "host/physics/tides.hpp"

#include "host/error.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu::physics {
namespace {

void check_positive(const char* what, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw Error(Fault::bad_argument, fmt::format("the {} is {}; it must be finite and above 0", what, value));
}

// Quadrupole along the principal axes; what is alike but for rounding is made so.
Vec3 clean_quadrupole(const PrincipalAxes& principal) {
  Vec3 q = principal.quadrupole;
  if (principal.first_two_alike) q[0] = q[1] = (q[0] + q[1]) / 2;
  if (principal.last_two_alike) q[1] = q[2] = (q[1] + q[2]) / 2;
  return is_isotropic(principal) ? Vec3(Vec3::Zero()) : q;
}

// I_b - I_a of principal axes, from what is left when the size is taken off.
struct Differences {
  Vec3 quadrupole;
  double operator()(int b, int a) const { return (quadrupole[a] - quadrupole[b]) / 3; }
};

Vec3 moments(const PrincipalAxes& principal) {
  return principal.moments.value();
}

} // namespace

const char* name(Stability stability) {
  switch (stability) {
  case Stability::lagrange: return "stable (Lagrange)";
  case Stability::debra_delp: return "stable without friction (DeBra-Delp)";
  case Stability::neutral: return "neutral";
  case Stability::unstable: return "unstable";
  }
  return "unknown";
}

bool is_isotropic(const PrincipalAxes& principal) {
  return principal.first_two_alike && principal.last_two_alike;
}

Orbit circular_orbit(const PointMass& centre, const RigidBody& body, double radius) {
  check_positive("mass at the centre of the orbit", centre.gm);
  check_positive("radius of the orbit", radius);
  if (body.radius_known && radius <= body.radius)
    throw Error(Fault::point_inside,
                fmt::format("the orbit of radius {} m runs inside the sphere of radius {} m about the body's centre of "
                            "mass that holds the body: its multipoles say nothing there; give a larger --orbit",
                            radius, body.radius));
  Orbit orbit;
  orbit.gm = centre.gm;
  orbit.radius = radius;
  orbit.gradient = centre.gm / radius / radius / radius;
  orbit.rate = std::sqrt((centre.gm + gravitational_constant_si * body.mass) / radius) / radius;
  if (!(orbit.gradient > 0) || !std::isfinite(orbit.rate))
    throw Error(Fault::bad_argument,
                fmt::format("an orbit of radius {} m is too large or too small to compute with", radius));
  return orbit;
}

Libration libration(const PrincipalAxes& principal, const Orbit& orbit, const std::array<int, 3>& axes) {
  const Differences apart{clean_quadrupole(principal)};
  const Vec3 i = moments(principal);
  const auto [x, y, z] = axes;
  const double g = orbit.gradient / (orbit.rate * orbit.rate);
  const double kx = apart(z, y) / i[x], ky = apart(z, x) / i[y], pitch = 3 * g * apart(y, x) / i[z];
  const double b = ky * (1 + 3 * g) + kx + (1 - kx) * (1 - ky), c = kx * ky * (1 + 3 * g);
  const double discriminant = b * b - 4 * c;
  Libration found;
  found.axes = axes;
  if (pitch > 0) found.pitch = orbit.rate * std::sqrt(pitch);
  if (discriminant >= 0) {
    // The two values of -s^2, without cancellation; those above 0 oscillate, in an unstable attitude too.
    const double larger = (b + std::copysign(std::sqrt(discriminant), b)) / 2, other = larger != 0 ? c / larger : 0;
    const auto rate = [&](double square) { return square > 0 ? orbit.rate * std::sqrt(square) : 0; };
    found.roll_yaw = {rate(std::min(larger, other)), rate(std::max(larger, other))};
  } else {
    // s^2 = -b/2 +- i sqrt(-discriminant)/2, of modulus sqrt(c): all four s have the same |Im s|.
    const double root = std::sqrt(c), twice = root + b / 2 > 0 ? root + b / 2 : -discriminant / 4 / (root - b / 2);
    found.roll_yaw.fill(orbit.rate * std::sqrt(twice / 2));
  }
  if (pitch < 0 || c < 0 || b < 0 || discriminant < 0)
    found.stability = Stability::unstable;
  else if (pitch > 0 && c > 0)
    found.stability = kx > 0 ? Stability::lagrange : Stability::debra_delp;
  return found;
}

std::vector<Libration> relative_equilibria(const PrincipalAxes& principal, const Orbit& orbit) {
  std::vector<Libration> all;
  for (const std::array<int, 3>& axes : {std::array{0, 1, 2}, {1, 0, 2}, {0, 2, 1}, {2, 0, 1}, {1, 2, 0}, {2, 1, 0}})
    all.push_back(libration(principal, orbit, axes));
  return all;
}

OrbitTorque orbit_torque(const RigidBody& body, const Orbit& orbit, const LongMat3& attitude) {
  const LongMat3 to_body = attitude.transpose();
  const LongVec3 x = -(long double)(orbit.radius) * to_body.col(0), z = to_body.col(2);
  OrbitTorque torque;
  const LongVec3 gravity = pull(body, orbit.gm, x).torque;
  torque.gravity = attitude * gravity;
  // z cross I z by the quadrupole: what I has in common with a ball's drops out.
  const long double n = orbit.rate;
  const LongVec3 turning = -n * n / 3 * z.cross(LongVec3(body.quadrupole.cast<long double>() * z));
  torque.rest = attitude * (gravity - turning);
  return torque;
}

ShiftedEquilibrium shifted_equilibrium(const RigidBody& body, const Orbit& orbit, const LongMat3& start) {
  const LongMat3 q = start * body.quadrupole.cast<long double>() * start.transpose();
  const auto apart = [&](int b, int a) { return (q(a, a) - q(b, b)) / 3; };
  const long double n2 = (long double)(orbit.rate) * orbit.rate, g3 = 3 * (long double)(orbit.gradient);
  const LongVec3 slope(-n2 * apart(2, 1), -(n2 + g3) * apart(2, 0), -g3 * apart(1, 0));
  const long double noise = 1e-9L * slope.cwiseAbs().maxCoeff();
  ShiftedEquilibrium found;
  found.attitude = start;
  long double before = 1;
  for (int round = 0; round < 200; ++round) {
    const LongVec3 rest = orbit_torque(body, orbit, found.attitude).rest;
    LongVec3 turn = LongVec3::Zero();
    for (int i = 0; i < 3; ++i)
      if (std::abs(slope[i]) > noise) turn[i] = -rest[i] / slope[i];
    const long double angle = turn.norm();
    if (!(angle < 0.5L)) return found;
    if (angle > 0) found.attitude = Eigen::AngleAxis<long double>(angle, turn / angle) * found.attitude;
    // Down to rounding: turns that no longer shrink are made of it.
    found.found = angle < 1e-17L || (angle < 1e-9L && angle > 0.9L * before);
    if (found.found) break;
    before = angle;
  }
  const LongMat3 total = found.attitude * start.transpose();
  // The vector part of a small turn, of which an angle out of its cosine would lose half the digits.
  const LongVec3 sine = LongVec3(total(2, 1) - total(1, 2), total(0, 2) - total(2, 0), total(1, 0) - total(0, 1)) / 2;
  const long double size = sine.norm();
  found.shift = size > 0 ? LongVec3(sine / size * std::atan2(size, (total.trace() - 1) / 2)) : LongVec3(sine);
  return found;
}

double largest_quadrupole_torque(const PrincipalAxes& principal, const Orbit& orbit) {
  return 1.5 * orbit.gradient * Differences{clean_quadrupole(principal)}(2, 0);
}

double capture_half_width(const PrincipalAxes& principal, const Orbit& orbit) {
  return std::sqrt(3 * orbit.gradient * Differences{clean_quadrupole(principal)}(1, 0) / moments(principal)[2]);
}

double locking_time(const RigidBody& body, const Orbit& orbit, double spin, double love, double quality) {
  check_positive("spin", spin);
  if (!(love > 0) || !(love <= largest_love))
    throw Error(Fault::bad_argument,
                fmt::format("the Love number k2 (--love) is {}; it is above 0 and at most {}, that of a uniform fluid",
                            love, largest_love));
  if (!(quality >= 1) || !(quality <= largest_quality))
    throw Error(Fault::bad_argument, fmt::format("the quality factor Q (--quality) is {}; it is from 1 to {:.0e}",
                                                 quality, largest_quality));
  const double moment = body.inertia().trace() / 3, radius = std::sqrt(2.5 * moment / body.mass);
  const double ratio = orbit.radius / radius; // r^6/R^5 may leave the range
  const double time = spin * moment * quality * gravitational_constant_si / (3 * love * orbit.gm * orbit.gm) *
                      std::pow(ratio, 5) * orbit.radius;
  if (!(time > 1e-290) || !(time < 1e290))
    throw Error(Fault::bad_argument,
                fmt::format("the time to lock, {:.3g} s, is too short or too long to compute with: change the spin of "
                            "{:.3g} rad/s or the orbit of {:.3g} m",
                            time, spin, orbit.radius));
  return time;
}

} // namespace cowgpu::physics
