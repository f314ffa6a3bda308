// One call that holds every path of the stage `potential` against the reference.
#pragma once

#include "host/backend.hpp"
#include "tests/support/compare_moments.hpp"

#include <array>
#include <vector>

namespace cowgpu::test {

/// A mass at a place.
struct PointMass {
  double mass = 1;
  Vec3 at = Vec3::Zero();
};

/// Moments of point masses about the origin, by the special functions of the standard library.
Multipoles point_moments(const std::vector<PointMass>& masses, int lmax, double radius);

/// Moments of no body in particular: every part of every Q_lm / R^l between -1 and 1.
Multipoles random_moments(int lmax, double radius, unsigned seed);

/// Points from R to `farthest` R, some of them on the axis, on the equator and at R itself.
std::vector<Vec3> points_outside(std::size_t count, double radius, double farthest, unsigned seed);

/// Without anybody watching.
PotentialField potential(Backend& backend, const PotentialProblem& problem, RunReport* report = nullptr);

/// Root mean square over the sphere through `at` of value, of the largest gradient and of the largest second derivative.
std::array<double, 3> potential_scale(const PotentialProblem& problem, const Vec3& at);

/// Errors against the reference in 80-bit arithmetic, at no more than about 64 of the points, are at most `figure` of
/// potential_scale() on every path.
void compare_potential(Paths& paths, const PotentialProblem& problem, double figure);

bool same_bits(const PotentialField& a, const PotentialField& b);

} // namespace cowgpu::test
