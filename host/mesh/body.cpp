#include "host/mesh/body.hpp"

#include "host/error.hpp"
#include "host/geometry/determinant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cowgpu {
namespace {

void check_density(double density) {
  if (!std::isfinite(density) || density == 0 || std::abs(density) > 1e50 || std::abs(density) < 1e-50)
    throw Error(Fault::bad_argument, fmt::format("the density {} must be finite and between 1e-50 and 1e50", density));
}

// Masses that cancel by more are summed from the triangles, in Quad: rounded volumes would leave too few digits.
constexpr long double lost_bits = 0x1p-6L;

// Integrals of the density and of it times x - o, over body and parts.
struct FirstMoments {
  Quad mass = 0;
  std::array<Quad, 3> first = {0, 0, 0};

  void add(const ClosedSurface& surface, double density, const Vec3& o) {
    const std::vector<Vec3>& vertices = surface.vertices();
    for (const Face& face : surface.faces()) {
      const Vec3 &a = vertices[face[0]], &b = vertices[face[1]], &c = vertices[face[2]];
      const Quad weight = Quad(density) * determinant_in<Quad>(a, b, c, o);
      mass += weight / 6;
      for (int i = 0; i < 3; ++i)
        first[std::size_t(i)] += weight / 24 * ((Quad(a[i]) - o[i]) + (Quad(b[i]) - o[i]) + (Quad(c[i]) - o[i]));
    }
  }
};

FirstMoments first_moments(const Body& body, const Vec3& o) {
  FirstMoments moments;
  moments.add(body.surface, body.density, o);
  for (const Part& part : body.parts) moments.add(part.surface, part.density, o);
  return moments;
}

// The mean of the centres, weighed by mass, as seen from the first of them; nothing where the masses cancel.
std::optional<Vec3> common_centre(const Body& body, const Vec3& own) {
  using Extended = Eigen::Matrix<long double, 3, 1>;
  const long double first = (long double)(body.density) * body.volume;
  long double mass = first, weight = std::abs(first);
  Extended sum = Extended::Zero();
  for (const Part& part : body.parts) {
    const long double m = (long double)(part.density) * part.volume;
    mass += m;
    weight += std::abs(m);
    sum += m * (part.centre_of_mass.cast<long double>() - own.cast<long double>());
  }
  if (!(std::abs(mass) > 1e-12L * weight)) return std::nullopt;
  if (std::abs(mass) < lost_bits * weight) {
    const FirstMoments exact = first_moments(body, own);
    Vec3 centre;
    for (int i = 0; i < 3; ++i) centre[i] = double(Quad(own[i]) + exact.first[std::size_t(i)] / exact.mass);
    return centre;
  }
  return Vec3((own.cast<long double>() + sum / mass).cast<double>());
}

} // namespace

Part::Part(ClosedSurface s, double d) : surface(std::move(s)), density(d) {
  check_density(density);
  volume = cowgpu::volume(surface);
  centre_of_mass = cowgpu::centre_of_mass(surface);
}

double Body::mass() const {
  long double sum = (long double)(density)*volume, sizes = std::abs(sum);
  for (const Part& part : parts) {
    const long double one = (long double)(part.density) * part.volume;
    sum += one;
    sizes += std::abs(one);
  }
  if (!(std::abs(sum) < lost_bits * sizes)) return double(sum);
  return double(first_moments(*this, bounding_box(surface).middle()).mass);
}

Units Body::units() const {
  Units own = placement.units;
  if (own.stated) own.kilogram = density * own.metre * own.metre * own.metre;
  return own;
}

Body make_body(ClosedSurface surface, const OriginChoice& origin, double density, std::vector<Part> parts) {
  check_density(density);
  if (origin.point && !origin.point->allFinite())
    throw Error(Fault::bad_argument, fmt::format("the origin ({}, {}, {}) must be finite", origin.point->x(),
                                                 origin.point->y(), origin.point->z()));
  if (origin.point.has_value() == (origin.kind == "centre of mass"))
    throw Error(Fault::bad_argument, fmt::format("an origin of the kind '{}' {}; \"centre of mass\" has none, and "
                                                 "\"mesh\" and \"given\" have one",
                                                 origin.kind, origin.point ? "has a point" : "has no point"));
  Body body(std::move(surface));
  body.density = density;
  body.parts = std::move(parts);
  body.volume = volume(body.surface);
  body.area = area(body.surface);
  body.box = bounding_box(body.surface);
  for (const Part& part : body.parts) {
    const Box box = bounding_box(part.surface);
    body.box = {body.box.min.cwiseMin(box.min), body.box.max.cwiseMax(box.max)};
  }
  const Vec3 own = centre_of_mass(body.surface);
  const std::optional<Vec3> centre = body.parts.empty() ? own : common_centre(body, own);
  if (!centre && !origin.point)
    throw Error(
        Fault::bad_argument,
        fmt::format("body and parts weigh {:.3g} together, nothing but rounding: they have no centre of mass to "
                    "take moments about; give --origin mesh or --origin X,Y,Z",
                    body.mass()));
  body.centre_of_mass = centre.value_or(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  body.origin = origin.point.value_or(body.centre_of_mass);
  body.origin_kind = origin.kind;
  const auto radius_about = [&](const Vec3& about) {
    double radius = brillouin_radius(body.surface, about);
    for (const Part& part : body.parts) radius = std::max(radius, brillouin_radius(part.surface, about));
    return radius;
  };
  body.brillouin_radius = radius_about(body.origin);
  const double size = radius_about(body.box.middle());
  if (!(body.brillouin_radius <= 1e6 * size))
    throw Error(Fault::bad_argument,
                fmt::format("the {} ({}, {}, {}) is {:.1e} body radii away; moments about it would be nothing but "
                            "rounding: {}",
                            origin.point ? "origin" : "centre of mass", body.origin.x(), body.origin.y(),
                            body.origin.z(), body.brillouin_radius / size,
                            origin.point
                                ? "choose one within 1e6 radii, or the centre of mass (--origin com)"
                                : "the volumes of shells or masses of parts nearly cancel. See by `cowgpu "
                                  "inspect` which way its shells look, or choose an origin within 1e6 radii by "
                                  "--origin X,Y,Z"));
  return body;
}

} // namespace cowgpu
