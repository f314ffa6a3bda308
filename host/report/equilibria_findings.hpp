// What is found out about the equilibria of a spinning body.
#pragma once

#include "host/mesh/triangle_surface.hpp"
#include "host/physics/equilibria.hpp"
#include "host/physics/findings.hpp"

#include <optional>
#include <string>

namespace cowgpu {

struct EquilibriaResult {
  physics::Subject subject;
  bool si = false;     ///< units are stated; else G = 1
  double constant = 1; ///< of gravity
  double mass = 0, density = 0;
  Vec3 centre_of_mass = Vec3::Zero();
  physics::Spin spin;
  bool axis_found = false; ///< the axis is that of the largest moment of inertia
  double synchronous = 0;  ///< cbrt(GM/w^2)
  physics::Equilibria equilibria;
  struct ZeroVelocity {
    double jacobi = 0, extent = 0, cell = 0; ///< extent: half side of the cube that was looked at
    TriangleSurface surface;
  };
  std::optional<ZeroVelocity> zero_velocity; ///< where it was asked for
  std::string device;                        ///< what computed it, in words
};

/// What `cowgpu equilibria` shows of it: rows, tables and notes with their units.
physics::Findings findings(const EquilibriaResult& result);

} // namespace cowgpu
