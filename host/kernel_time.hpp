// What one kernel took, in the reports of the verbs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cowgpu {

/// Time one kernel took on a device, summed over its dispatches.
struct KernelTime {
  std::string kernel;
  std::uint64_t dispatches = 0;
  double seconds = 0;
};

} // namespace cowgpu
