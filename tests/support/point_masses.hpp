// Bodies of point masses, whose multipoles and gravity have a closed form.
#pragma once

#include "host/physics/point_mass.hpp"

#include <Eigen/Geometry>

#include <cmath>
#include <vector>

namespace cowgpu::test {

struct Point {
  double mass;
  Vec3 place;
};

/// Moves them to their centre of mass.
inline std::vector<Point> centred(std::vector<Point> points) {
  double mass = 0;
  Vec3 sum = Vec3::Zero();
  for (const Point& p : points) mass += p.mass, sum += p.mass * p.place;
  for (Point& p : points) p.place -= sum / mass;
  return points;
}

/// Q_lm / R^l about the origin, R the largest distance.
inline Multipoles moments_of(const std::vector<Point>& points, int lmax) {
  Multipoles q(lmax);
  q.reference_radius = 0;
  for (const Point& p : points) q.reference_radius = std::max(q.reference_radius, p.place.norm());
  for (const Point& p : points)
    for (int l = 0; l <= lmax; ++l)
      for (int m = 0; m <= l; ++m) {
        const double r = p.place.norm(), theta = std::acos(p.place.z() / r), phi = std::atan2(p.place.y(), p.place.x());
        q(l, m) += p.mass * std::pow(r / q.reference_radius, l) *
                   std::polar(std::sph_legendre(unsigned(l), unsigned(m), theta), m * phi);
      }
  return q;
}

/// About their centre of mass, which is the origin; each a ball of `own` m^2 times its mass as integral of r^2, so that rods have
/// a moment of inertia about themselves.
inline physics::RigidBody body_of(const std::vector<Point>& points, int order, double own = 0.01) {
  physics::RigidBody t;
  t.trace = 0;
  for (const Point& p : points) {
    t.mass += p.mass;
    *t.trace += p.mass * (p.place.squaredNorm() + own);
    t.quadrupole += p.mass * (3 * p.place * p.place.transpose() - p.place.squaredNorm() * Eigen::Matrix3d::Identity());
    t.radius = std::max(t.radius, p.place.norm());
  }
  t.units.stated = true;
  return physics::with_moments(t, moments_of(points, order), order);
}

/// Newton's force and torque of a point mass at x on the points, degree 0 included.
inline physics::Pull newton(const std::vector<Point>& points, long double gm, const physics::LongVec3& x) {
  physics::Pull sum;
  for (const Point& p : points) {
    const physics::LongVec3 place = p.place.cast<long double>(), d = x - place;
    const long double r = d.norm();
    const physics::LongVec3 force = gm * p.mass / (r * r * r) * d;
    sum.force += force;
    sum.torque += place.cross(force);
    sum.energy -= gm * p.mass / r;
  }
  return sum;
}

/// A body with these principal moments of inertia along x, y and z.
inline physics::RigidBody body_with(const Vec3& moments, double mass = 1) {
  physics::RigidBody t;
  t.mass = mass;
  t.trace = moments.sum() / 2;
  t.quadrupole = Eigen::Matrix3d(Vec3(Vec3::Constant(moments.sum()) - 3 * moments).asDiagonal());
  t.radius = std::sqrt(*t.trace / mass);
  t.units.stated = true;
  return physics::with_moments(t, {}, 2);
}

} // namespace cowgpu::test
