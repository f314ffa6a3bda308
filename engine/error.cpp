#include "engine/error.hpp"

#include <fmt/format.h>
#include <volk.h>

namespace cowgpu::engine {

std::string describe_result(int result) {
  switch (result) {
  case VK_SUCCESS: return "VK_SUCCESS";
  case VK_TIMEOUT: return "VK_TIMEOUT (the device did not finish in time)";
  case VK_ERROR_OUT_OF_HOST_MEMORY: return "VK_ERROR_OUT_OF_HOST_MEMORY (the machine is out of memory)";
  case VK_ERROR_OUT_OF_DEVICE_MEMORY: return "VK_ERROR_OUT_OF_DEVICE_MEMORY (the device is out of memory)";
  case VK_ERROR_INITIALIZATION_FAILED: return "VK_ERROR_INITIALIZATION_FAILED (the driver could not start)";
  case VK_ERROR_DEVICE_LOST: return "VK_ERROR_DEVICE_LOST (the device hung, was reset or was removed)";
  case VK_ERROR_LAYER_NOT_PRESENT: return "VK_ERROR_LAYER_NOT_PRESENT (a Vulkan layer is not installed)";
  case VK_ERROR_EXTENSION_NOT_PRESENT: return "VK_ERROR_EXTENSION_NOT_PRESENT (the driver lacks an extension)";
  case VK_ERROR_FEATURE_NOT_PRESENT: return "VK_ERROR_FEATURE_NOT_PRESENT (the device lacks a feature)";
  case VK_ERROR_INCOMPATIBLE_DRIVER: return "VK_ERROR_INCOMPATIBLE_DRIVER (no driver for this Vulkan version)";
  case VK_ERROR_TOO_MANY_OBJECTS: return "VK_ERROR_TOO_MANY_OBJECTS (too many allocations)";
  default: return fmt::format("VkResult {}", result);
  }
}

} // namespace cowgpu::engine
