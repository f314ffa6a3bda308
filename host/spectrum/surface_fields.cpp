#include "host/spectrum/surface_fields.hpp"

#include "host/parallel.hpp"

#include <cmath>
#include <numbers>

namespace cowgpu {
namespace {

// In (-pi, pi], for differences of two azimuths from [-pi, pi] and [0, 2 pi).
double wrapped(double angle) {
  while (angle > std::numbers::pi) angle -= 2 * std::numbers::pi;
  while (angle <= -std::numbers::pi) angle += 2 * std::numbers::pi;
  return angle;
}

} // namespace

std::array<double, 6> surface_field_values(const Vec3& position, const Vec3& origin, double theta, double phi,
                                           bool signed_dphi) {
  const Vec3 from_origin = position - origin;
  const double r = from_origin.norm();
  double dtheta = 0, dphi = 0;
  if (r > 0) {
    dtheta = std::atan2(std::hypot(from_origin.x(), from_origin.y()), from_origin.z()) - theta;
    dphi = wrapped(std::atan2(from_origin.y(), from_origin.x()) - phi);
  }
  return {r, dtheta, signed_dphi ? dphi : std::abs(dphi), position.x(), position.y(), position.z()};
}

std::vector<double> surface_fields(const std::vector<double>& positions, const SphereGrid& grid, const Vec3& origin,
                                   bool signed_dphi) {
  const std::size_t n = grid.points(), length = std::size_t(grid.ring_length);
  std::vector<double> values(6 * n);
  parallel_for(0, std::size_t(grid.rings), [&](std::size_t ring, unsigned) {
    for (std::size_t j = 0; j < length; ++j) {
      const std::size_t p = ring * length + j;
      const auto of_point = surface_field_values({positions[p], positions[n + p], positions[2 * n + p]}, origin,
                                                 grid.theta[ring], grid.phi(int(j)), signed_dphi);
      for (std::size_t f = 0; f < 6; ++f) values[f * n + p] = of_point[f];
    }
  });
  return values;
}

} // namespace cowgpu
