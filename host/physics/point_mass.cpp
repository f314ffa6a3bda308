#include "host/physics/point_mass.hpp"

#include "host/reference/potential.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace cowgpu::physics {

LongMat3 turn_about(const Vec3& axis, double degrees) {
  const double turn = std::remainder(degrees, 360.0), rest = std::remainder(turn, 90.0);
  const auto quarters = int(std::lround((turn - rest) / 90));
  constexpr int sines[] = {0, 1, 0, -1};
  const long double angle = rest / 180 * std::numbers::pi_v<long double>;
  const long double s0 = sines[(quarters + 4) % 4], c0 = sines[(quarters + 5) % 4];
  const long double s = s0 * std::cos(angle) + c0 * std::sin(angle), c = c0 * std::cos(angle) - s0 * std::sin(angle);
  const LongVec3 a = axis.cast<long double>() / axis.cast<long double>().norm();
  LongMat3 cross;
  cross << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return LongMat3::Identity() + s * cross + (1 - c) * cross * cross;
}

Pull pull(const RigidBody& body, long double gm, const LongVec3& x) {
  const long double r2 = x.squaredNorm(), r5 = r2 * r2 * std::sqrt(r2);
  const LongVec3 qx = body.quadrupole.cast<long double>() * x;
  const long double xqx = x.dot(qx);
  LongVec3 gradient = (qx - 5 * xqx / (2 * r2) * x) / r5, across = x.cross(qx) / r5;
  long double potential = xqx / (2 * r5);
  if (body.higher) {
    const auto more = (*body.higher)(x);
    gradient += more.gradient;
    across += x.cross(more.gradient);
    potential += more.value;
  }
  return {-gm * gradient, -gm * across, -gm * potential};
}

} // namespace cowgpu::physics
