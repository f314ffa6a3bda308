// What the engine says when Vulkan fails.
#pragma once

#include <stdexcept>
#include <string>

namespace cowgpu::engine {

enum class Failure {
  no_loader,    ///< libvulkan could not be loaded
  no_device,    ///< no physical device, or none that was asked for
  no_fp64,      ///< the device has no shaderFloat64
  out_of_range, ///< a limit of the device is exceeded
  vulkan,       ///< a Vulkan call failed
  device_lost,  ///< VK_ERROR_DEVICE_LOST, now or earlier on this device
  cut_short,    ///< the device ended a loop early, so the result is not whole
  stopped,      ///< the caller's hook asked to stop
};

/// A failure, the VkResult behind it (0 where there is none) and sentences: what, on which device, why, what to try.
class Error : public std::runtime_error {
public:
  Error(Failure failure, int result, const std::string& sentence)
      : std::runtime_error(sentence), failure_(failure), result_(result) {}
  Failure failure() const { return failure_; }
  int result() const { return result_; }

private:
  Failure failure_;
  int result_;
};

/// "VK_ERROR_OUT_OF_DEVICE_MEMORY" and what it usually means.
std::string describe_result(int result);

} // namespace cowgpu::engine
