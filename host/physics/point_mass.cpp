#include "host/physics/point_mass.hpp"

#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/physics/potential.hpp"
#include "host/reference/potential.hpp"
#include "host/spectrum/mass_moments.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace cowgpu::physics {

MassiveBody massive_body(const MassTensors& tensors, Multipoles moments, int order) {
  MassiveBody body;
  body.mass = tensors.mass;
  body.inertia = tensors.inertia();
  body.quadrupole = tensors.quadrupole;
  body.radius = tensors.radius;
  body.radius_known = tensors.radius_known;
  body.order = order;
  check_weighs(tensors);
  if (order < 3) return body;
  for (int l = 0; l <= 2; ++l)
    for (int m = 0; m <= l; ++m) moments(l, m) = 0;
  body.higher = std::make_shared<const reference::ExteriorPotential<long double>>(moments, order);
  return body;
}

MassiveBody massive_body(const Body& body, int order, Monitor& monitor) {
  const MassTensors tensors = about_centre(mass_tensors(body));
  if (order < 3) return massive_body(tensors, {}, order);
  return massive_body(tensors, mass_moments(mass_problems(body, order, 0), *make_cpu_backend(), monitor), order);
}

MassiveBody massive_body(const CoefficientSet& set, const MassTensors& tensors, double unit_m, double unit_kg,
                         int order) {
  const MassTensors centred = about_centre(tensors);
  if (order < 3) return massive_body(centred, {}, order);
  if (set.lmax < order)
    throw Error(Fault::file_format,
                fmt::format("these coefficients end at degree {}, and --order {} was asked for", set.lmax, order));
  if (tensors.first_moment.norm() > 1e-6 * tensors.mass * tensors.radius)
    throw Error(
        Fault::file_format,
        fmt::format("these coefficients are about a point {:.3g} m off the centre of mass, about which the body "
                    "turns; degrees above 2 are those of that point: take --order 2, or the mesh",
                    tensors.first_moment.norm() / tensors.mass));
  return massive_body(centred, in_si(mass_moments(set, order), unit_m, unit_kg), order);
}

Pull pull(const MassiveBody& body, long double gm, const LongVec3& x) {
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
