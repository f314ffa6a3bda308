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

physics::Findings findings(const TensorsResult& result);

} // namespace cowgpu
