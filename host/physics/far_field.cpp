#include "host/physics/far_field.hpp"

#include "host/mass/mass_moments.hpp"
#include "host/mesh/geometry.hpp"
#include "host/physics/potential.hpp"
#include "host/reference/moments.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cowgpu::physics {
namespace {

using Real = long double;
using LongVector = Eigen::Matrix<Real, 3, 1>;

constexpr Real extended_rounding = std::numeric_limits<Real>::epsilon();
constexpr Real double_rounding = std::numeric_limits<double>::epsilon();

// Sum of |det(a, b, c)|/6 over the faces, seen from `centre`.
Real bound_of(const ClosedSurface& surface, const Vec3& centre) {
  Real sum = 0;
  const auto from_centre = [&](std::uint32_t v) {
    return LongVector(surface.vertices()[v].cast<Real>() - centre.cast<Real>());
  };
  for (const Face& f : surface.faces()) {
    const LongVector a = from_centre(f[0]), b = from_centre(f[1]), c = from_centre(f[2]);
    sum += std::fabs(a.dot((b - a).cross(c - a))) / 6;
  }
  return sum;
}

} // namespace

Middle middle(const Body& body) {
  Middle found;
  found.centre = body.box.middle();
  found.radius = brillouin_radius(body.surface, found.centre);
  for (const Part& part : body.parts)
    found.radius = std::max(found.radius, brillouin_radius(part.surface, found.centre));
  return found;
}

FarField::FarField(const Body& body, const Monitor& monitor) {
  const auto [centre, radius] = middle(body);
  centre_ = centre;
  radius_ = radius;
  std::vector<Real> sum;
  for (MomentProblem problem : mass_problems(body, degree, 0)) {
    problem.origin = centre;
    problem.reference_radius = radius;
    check_stop(monitor);
    const std::vector<Real> part = reference::moments<Real>(problem, extended_rounding, monitor);
    sum.resize(part.size());
    for (std::size_t i = 0; i < part.size(); ++i) sum[i] += part[i];
  }
  bound_ = std::fabs(body.density) * bound_of(body.surface, centre);
  for (const Part& part : body.parts) bound_ += std::fabs(part.density) * bound_of(part.surface, centre);
  Multipoles moments(degree);
  moments.origin = centre;
  moments.reference_radius = radius;
  for (std::size_t i = 0; i < moments.values.size(); ++i)
    moments.values[i] = {double(sum[2 * i]), double(sum[2 * i + 1])};
  sizes_ = degree_sizes(moments, radius);
  series_.emplace(moments);
}

reference::PotentialAt<Real> FarField::at(const LongVector& point) const {
  return (*series_)(point - centre_.cast<Real>());
}

FieldError FarField::error(Real distance) const {
  const Real x = radius_ / distance, infinity = std::numeric_limits<Real>::infinity();
  if (!(x < 1)) return {infinity, infinity, infinity};
  FieldError error;
  Real power = 1;
  for (int l = 0; l <= degree; ++l, power *= x) {
    const Real rounded = (double_rounding * sizes_[std::size_t(l)] + 8 * extended_rounding * bound_) * power;
    error.value += rounded;
    error.gradient += rounded * (l + 1);
    error.hessian += rounded * (l + 1) * (l + 2);
  }
  const Real rest = bound_ * power / (1 - x), next = (degree + 2) / (1 - x);
  error.value = (error.value + rest) / distance;
  error.gradient = (error.gradient + rest * next) / distance / distance;
  error.hessian = (error.hessian + rest * next * (next + 1)) / distance / distance / distance;
  return error;
}

} // namespace cowgpu::physics
