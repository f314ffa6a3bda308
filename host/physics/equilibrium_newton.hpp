// Newton's method for the places where the effective acceleration of a spinning body vanishes.
#pragma once

#include "host/backend.hpp"
#include "host/mesh/body.hpp"
#include "host/monitor.hpp"
#include "host/physics/equilibria.hpp"
#include "host/types.hpp"

#include <span>
#include <vector>

namespace cowgpu::physics {

struct Start {
  Vec3 at = Vec3::Zero(); ///< in mesh coordinates
  double reach = 0;       ///< how far from there the place may be
};

class EquilibriumNewton {
public:
  EquilibriumNewton(const Body& body, double constant, const Spin& spin, const Backend& backend);

  /// From all starts together, by direct sums. Those that converge within their reach, each once: places nearer to each other than
  /// 1e-9 radii of the body are one. Steps end where they no longer make |grad W| smaller; it is then rounding, at most
  /// 1e-11 G M/R^2. No result where a step comes upon an edge.
  std::vector<Equilibrium> from(std::span<const Start> starts, Monitor& monitor) const;

private:
  SpinningField field_;
  Spin spin_;
  double radius_ = 0, gravity_ = 0, density_ = 0;
};

} // namespace cowgpu::physics
