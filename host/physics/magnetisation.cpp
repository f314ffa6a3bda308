#include "host/physics/magnetisation.hpp"

#include <numbers>

namespace cowgpu::physics {

std::vector<Vec3> magnetic_induction(std::span<const SymmetricTensor> hessian, const Vec3& magnetisation) {
  std::vector<Vec3> induction;
  induction.reserve(hessian.size());
  const Vec3 m = vacuum_permeability / (4 * std::numbers::pi) * magnetisation;
  for (const SymmetricTensor& h : hessian) {
    // Sums of two diagonal elements in place of differences with the trace.
    induction.emplace_back(-(h[3] + h[5]) * m[0] + h[1] * m[1] + h[2] * m[2],
                           h[1] * m[0] - (h[0] + h[5]) * m[1] + h[4] * m[2],
                           h[2] * m[0] + h[4] * m[1] - (h[0] + h[3]) * m[2]);
  }
  return induction;
}

} // namespace cowgpu::physics
