// Vulkan calls that fail when they are told to: volk's function pointers, replaced.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

namespace cowgpu::test {

/// The calls that can be made to fail, and as what.
enum class VulkanCall {
  allocate, ///< vkAllocateMemory: out of device memory
  buffer,   ///< vkCreateBuffer: out of host memory
  view,     ///< vkCreateBufferView: out of host memory
  map,      ///< vkMapMemory: memory map failed
  module,   ///< vkCreateShaderModule: out of host memory
  pipeline, ///< vkCreateComputePipelines: out of host memory
  sets,     ///< vkAllocateDescriptorSets: out of pool memory
  commands, ///< vkAllocateCommandBuffers: out of host memory
  fence,    ///< vkCreateFence: out of device memory
  submit,   ///< vkQueueSubmit: device lost, nothing is run
  wait,     ///< vkWaitForFences: device lost, after it has waited
  hang,     ///< vkWaitForFences: timeout, also once the fence is signalled
};
inline constexpr std::size_t vulkan_calls = 12;
inline constexpr int for_ever = std::numeric_limits<int>::max();
std::string_view name(VulkanCall call);

/// While one lives, Vulkan calls of this process pass through it. Made after the last device was opened (opening one loads
/// the pointers anew), and outlives the devices whose memory it counts. One at a time.
class VulkanFaults {
public:
  VulkanFaults();
  ~VulkanFaults();
  VulkanFaults(const VulkanFaults&) = delete;
  VulkanFaults& operator=(const VulkanFaults&) = delete;

  /// The n-th call from now on, counted from 0, and `times` - 1 after it fail; the others do not. Counts start anew.
  void arm(VulkanCall call, int n, int times = 1);
  void disarm();
  /// Calls since then.
  int seen(VulkanCall call) const;
  /// Allocations and buffers that were made and not freed while this lived.
  int live_memory() const;
  int live_buffers() const;
  /// The most bytes that were allocated at one time since it was made or disarmed.
  std::uint64_t most_bytes() const;
  /// Allocations, buffers, fences, pipelines and devices destroyed since the call that was armed last failed.
  int destroyed_since() const;
};

} // namespace cowgpu::test
