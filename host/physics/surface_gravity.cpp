#include "host/physics/surface_gravity.hpp"

#include "host/error.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace cowgpu::physics {
namespace {

double mean(const std::vector<double>& values, const std::vector<double>& weights) {
  long double sum = 0, weight = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += (long double)(weights[i]) * values[i];
    weight += weights[i];
  }
  return double(sum / weight);
}

} // namespace

Vec3 largest_principal_axis(const Body& body) {
  const PrincipalAxes principal = principal_axes(about_centre(rigid_body(body)));
  if (principal.last_two_alike)
    throw Error(Fault::bad_argument,
                principal.first_two_alike
                    ? "the body has three equal moments of inertia, as a ball has, and so no axis of the largest one: "
                      "say by --spin x,y,z what it turns about"
                    : "the two largest moments of inertia of the body are equal, so that none of its axes has the "
                      "largest one: say by --spin x,y,z what it turns about");
  const Vec3 axis = principal.axes.col(2);
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? Vec3(-axis) : axis;
}

SurfaceGravity surface_gravity(const SurfacePlaces& places, const PotentialField& field, const FieldLaw& law,
                               const Spin& spin, const Vec3& centre_of_mass) {
  const std::size_t count = places.at.size();
  const bool plates = places.place != ValuePlace::points;
  SurfaceGravity found;
  found.potential.resize(count);
  found.gravity.resize(count);
  found.geopotential.resize(count);
  found.escape_speed.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 r = places.at[i] - spin.through;
    const Vec3 out = spin.rate == 0 ? Vec3(Vec3::Zero()) : Vec3(r - spin.axis * spin.axis.dot(r)); // from the axis
    const Vec3 velocity = spin.rate * spin.axis.cross(out);
    found.potential[i] = law.potential(field.value[i]);
    found.gravity[i] = law.force(field.gradient[i]) + spin.rate * spin.rate * out;
    found.geopotential[i] = found.potential[i] - velocity.squaredNorm() / 2;
    found.escape_speed[i] = found.potential[i] < 0 ? std::sqrt(-2 * found.potential[i]) : 0;
  }
  if (!plates) return found;
  found.mean_geopotential = mean(found.geopotential, places.areas);
  found.slope.resize(count);
  found.elevation.resize(count);
  found.tilt.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    found.slope[i] = angle_between(-found.gravity[i], places.normals[i]);
    found.elevation[i] = (found.geopotential[i] - found.mean_geopotential) / found.gravity[i].stableNorm();
    found.tilt[i] = angle_between(places.normals[i], places.at[i] - centre_of_mass);
  }
  return found;
}

} // namespace cowgpu::physics
