#include "host/mesh/body.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cowgpu {

Body make_body(ClosedSurface surface, const OriginChoice& origin, double density) {
  if (!std::isfinite(density) || density == 0 || std::abs(density) > 1e50 || std::abs(density) < 1e-50)
    throw Error(Fault::bad_argument, fmt::format("the density {} must be finite and between 1e-50 and 1e50", density));
  Body body(std::move(surface));
  body.density = density;
  body.volume = volume(body.surface);
  body.area = area(body.surface);
  body.centre_of_mass = centre_of_mass(body.surface);
  body.box = bounding_box(body.surface);
  body.origin = origin.point.value_or(body.centre_of_mass);
  body.origin_kind = origin.kind;
  body.brillouin_radius = brillouin_radius(body.surface, body.origin);
  const double own = brillouin_radius(body.surface, body.box.middle());
  if (!(body.brillouin_radius <= 1e6 * own))
    throw Error(Fault::bad_argument,
                fmt::format("the origin ({}, {}, {}) is {:.1e} body radii away; moments about it would be nothing but "
                            "rounding: choose one within 1e6 radii, or the centre of mass",
                            body.origin.x(), body.origin.y(), body.origin.z(), body.brillouin_radius / own));
  return body;
}

} // namespace cowgpu
