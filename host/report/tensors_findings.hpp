// What is found out about a body's tensors.
#pragma once

#include "host/physics/findings.hpp"
#include "host/physics/rigid_body.hpp"

namespace cowgpu {

struct TensorsResult {
  physics::Subject subject;
  physics::RigidBody body; ///< about its origin
  physics::PrincipalAxes principal;
};

/// What `cowgpu tensors` shows of it: rows, tables and notes with their units.
physics::Findings findings(const TensorsResult& result);

} // namespace cowgpu
