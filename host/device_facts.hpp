// What a device is.
#pragma once

#include <cstdint>
#include <string>

namespace cowgpu {

/// What a device is and can do, in words and plain numbers.
struct DeviceFacts {
  std::string name;   ///< "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::string type;   ///< "discrete", "integrated", "virtual", "software", "cpu" or "other"
  std::string driver; ///< name and version of the driver, or the instruction set
  std::string api;    ///< "Vulkan 1.3.230", "native"
  bool fp64 = true;
  bool usable = true;               ///< has all that cowgpu needs
  std::uint32_t subgroup = 1;       ///< lanes that run in step
  std::uint64_t memory = 0;         ///< bytes of the largest device-local heap (0: not known)
  std::uint64_t largest_buffer = 0; ///< bytes one shader binding may span (0: no limit)
  std::uint32_t shared_memory = 0;  ///< bytes of memory shared by a workgroup
  unsigned threads = 1;             ///< threads of the CPU path
};

} // namespace cowgpu
