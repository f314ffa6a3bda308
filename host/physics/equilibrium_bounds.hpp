// How fast the acceleration of gravity can change near a place, whatever the body's shape: what tells where it cannot vanish.
//
// All bounds hold for densities from 0 to a largest one. The field of a ball of half that density about the place, which holds
// the body, is known; what is left has at most half the density, of either sign.
#pragma once

#include "host/types.hpp"

#include <Eigen/Core>

#include <vector>

namespace cowgpu::physics {

class GravityBounds {
public:
  /// `density` is G times the largest density, `mass` G times the mass of what lies in the box [low, high].
  GravityBounds(double density, double mass, const Vec3& low, const Vec3& high);

  double density() const { return density_; }

  /// Of grad V(x + d) - grad V(x) + (4 pi/3) (density/2) d over |d| <= h, where no part of the body is farther than `reach`
  /// from x. With k(y) = y/|y|^3 the integral of |k(y - d) - k(y)| over a ball of radius T |d| about 0 is at most
  /// |d| (c ln T + 18.8), c = 4 pi (1 + asinh(sqrt 3)/(2 sqrt 3)) = 17.344; the second number is a quadrature's, 18.73 at T = 1 and
  /// less at any larger one.
  double change(double reach, double h) const;

  /// Of grad V(x + d) - grad V(x) - dd V(x) d over |d| <= h, where the nearest surface is at a distance `depth` > h from x.
  /// Infinite elsewhere. Beyond the nearest surface the third derivatives of 1/r along d, 3 sqrt(5 c^4 - 2 c^2 + 1)/r^4 with
  /// the angle's cosine c, add up to at most (density/2) 4 pi 3.36/(depth - h); outside the body also to what outer_third() says.
  double remainder(const Vec3& x, double depth, bool outside, double h) const;

  /// Of the norm of dd V(x + d) - dd V(x) over |d| <= h < depth, by the largest third derivative of 1/r, 6/r^4.
  double gradient_change(const Vec3& x, double depth, bool outside, double h) const;

  /// The largest h, no more than `depth`, with gradient_change(x, depth, outside, h) < stiffness.
  double injective_within(const Vec3& x, double depth, bool outside, double stiffness) const;

private:
  double outer_third(const Vec3& x, double depth, double h) const;

  double density_, mass_;
  std::vector<Vec3> parts_; // centres of parts of the box
  Vec3 half_;               // of each
};

/// A lower bound of |a + J d| over the box of half sides `half`, J symmetric: by planes that separate the box's image from 0, whose
/// normals are a, J's eigenvectors and what a few steps towards the nearest point find.
double least_over_box(const Vec3& a, const Eigen::Matrix3d& gradient, const Vec3& half);

} // namespace cowgpu::physics
