#include "host/requests/tensors.hpp"

namespace cowgpu {

TensorsResult tensors(const TensorsRequest& request, Monitor& monitor) {
  const LoadedMass loaded = load_mass(request.body, Motion::held, monitor);
  TensorsResult result;
  result.subject = subject(loaded);
  result.body = rigid_body(loaded);
  if (request.inertia) result.body.inertia(); // its error names what is missing
  result.principal = physics::principal_axes(result.body);
  return result;
}

} // namespace cowgpu
