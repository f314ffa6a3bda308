// How much memory a call of a verb takes.
#pragma once

#include <cstdint>

namespace cowgpu {

/// Upper bounds, in bytes: on the host, and on the device.
struct MemoryNeed {
  std::uint64_t host = 0;
  std::uint64_t device = 0;
};

} // namespace cowgpu
