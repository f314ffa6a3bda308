#include "host/cli/physics.hpp"

#include "host/report/beside_paper.hpp"
#include "host/requests/tensors.hpp"

namespace cowgpu::cli {

Solve add_tensors(Command& command, Common&, BodyOptions&) {
  const auto inertia = std::make_shared<bool>(false);
  command.add_flag("--inertia", *inertia, "The inertia is what is wanted: refuse a file that does not give it");
  return [inertia](const PhysicsCall& call) {
    ConsoleMonitor monitor(ProgressStyle::none);
    const TensorsResult result = tensors({call.body, *inertia}, monitor);
    physics::Findings found = findings(result);
    if (call.paper) found.paper = beside_paper(result);
    return found;
  };
}

} // namespace cowgpu::cli
