// The tensors of a body: quadrupole, inertia, second moment, principal axes.
#pragma once

#include "host/report/tensors_findings.hpp"
#include "host/requests/load_body.hpp"

namespace cowgpu {

struct TensorsRequest {
  BodyRequest body;
  bool inertia = false; ///< a file that does not give it is refused
};

/// About the body's origin, in SI where units are stated. Throws what load_mass() and physics::rigid_body() throw, and
/// Error(file_format) for an inertia that is asked for and not there.
TensorsResult tensors(const TensorsRequest& request, Monitor& monitor);

} // namespace cowgpu
