// The field of a body of uniform parts far away, where the polyhedron's closed form is the difference of large numbers.
#pragma once

#include "host/mesh/body.hpp"
#include "host/monitor.hpp"
#include "host/multipoles.hpp"
#include "host/physics/polyhedron.hpp"
#include "host/reference/potential.hpp"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace cowgpu::physics {

/// The series of a body's moments about the middle of its box, which does not depend on the body's origin. The moments are
/// summed in 80-bit arithmetic and rounded once, so that what is left of thin and hollow bodies is right too.
class FarField {
public:
  static constexpr int degree = 32;

  /// Throws Error(interrupted).
  FarField(const Body& body, const Monitor& monitor);

  /// `point` in mesh coordinates, outside radius() about centre().
  reference::PotentialAt<long double> at(const Eigen::Matrix<long double, 3, 1>& point) const;

  const Vec3& centre() const { return centre_; }
  double radius() const { return radius_; }

  /// At `distance` from centre(): the degrees left out, by |V_l| <= B R^l / distance^(l+1) with B the sum of all |det|/6 times
  /// |density|, and the rounding of the moments. Infinite where distance <= radius().
  FieldError error(long double distance) const;

private:
  Vec3 centre_ = Vec3::Zero();
  double radius_ = 0;
  long double bound_ = 0;     // B
  std::vector<double> sizes_; // sizes of the degrees, at the radius
  std::optional<reference::ExteriorPotential<long double>> series_;
};

/// The middle of the box of a body and its parts, and the largest distance of a vertex from it.
struct Middle {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
};
Middle middle(const Body& body);

} // namespace cowgpu::physics
