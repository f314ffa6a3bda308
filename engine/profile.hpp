// Where a device's time goes.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace cowgpu::engine {

/// Time the device spent in each kernel, from timestamps around its dispatches (engine/job.cpp).
struct Profile {
  struct Entry {
    std::uint64_t dispatches = 0;
    double seconds = 0;
  };
  std::map<std::string, Entry> kernels;
};

} // namespace cowgpu::engine
