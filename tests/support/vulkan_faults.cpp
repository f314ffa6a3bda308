#include "tests/support/vulkan_faults.hpp"

#include <volk.h>

#include <array>
#include <atomic>

namespace cowgpu::test {
namespace {

constexpr std::array<VkResult, vulkan_calls> results = {
    VK_ERROR_OUT_OF_DEVICE_MEMORY, VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_HOST_MEMORY,
    VK_ERROR_MEMORY_MAP_FAILED,    VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_HOST_MEMORY,
    VK_ERROR_OUT_OF_POOL_MEMORY,   VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_DEVICE_MEMORY,
    VK_ERROR_DEVICE_LOST,          VK_ERROR_DEVICE_LOST,        VK_TIMEOUT};

std::array<std::atomic<int>, vulkan_calls> seen_calls, fails_at;
std::atomic<int> memory = 0, buffers = 0;

bool fails(VulkanCall call) {
  const auto c = std::size_t(call);
  return seen_calls[c]++ == fails_at[c];
}

// One of the pointers, and what stands in its place.
template <VulkanCall call, class... Arguments>
struct Hook {
  using Function = VkResult(VKAPI_PTR*)(Arguments...);
  static inline Function real = nullptr;
  static VKAPI_ATTR VkResult VKAPI_CALL stand_in(Arguments... arguments) {
    if (fails(call)) return results[std::size_t(call)];
    const VkResult result = real(arguments...);
    if (result == VK_SUCCESS && call == VulkanCall::allocate) ++memory;
    if (result == VK_SUCCESS && call == VulkanCall::buffer) ++buffers;
    return result;
  }
};

template <VulkanCall call, class... Arguments>
void put(VkResult(VKAPI_PTR*& slot)(Arguments...)) {
  Hook<call, Arguments...>::real = slot;
  slot = Hook<call, Arguments...>::stand_in;
}

template <VulkanCall call, class... Arguments>
void take_back(VkResult(VKAPI_PTR*& slot)(Arguments...)) {
  if (slot == Hook<call, Arguments...>::stand_in) slot = Hook<call, Arguments...>::real;
}

PFN_vkWaitForFences real_wait;
PFN_vkFreeMemory real_free;
PFN_vkDestroyBuffer real_destroy;

// The work is over when the loss is told: what the device still uses must not be freed.
VKAPI_ATTR VkResult VKAPI_CALL wait_stand_in(VkDevice device, std::uint32_t count, const VkFence* fences, VkBool32 all,
                                             std::uint64_t timeout) {
  const VkResult result = real_wait(device, count, fences, all, timeout);
  if (fails(VulkanCall::wait)) return results[std::size_t(VulkanCall::wait)];
  if (fails(VulkanCall::hang)) return results[std::size_t(VulkanCall::hang)];
  return result;
}

VKAPI_ATTR void VKAPI_CALL free_stand_in(VkDevice device, VkDeviceMemory handle,
                                         const VkAllocationCallbacks* callbacks) {
  if (handle) --memory;
  real_free(device, handle, callbacks);
}

VKAPI_ATTR void VKAPI_CALL destroy_stand_in(VkDevice device, VkBuffer handle, const VkAllocationCallbacks* callbacks) {
  if (handle) --buffers;
  real_destroy(device, handle, callbacks);
}

} // namespace

std::string_view name(VulkanCall call) {
  constexpr std::array<std::string_view, vulkan_calls> names = {
      "allocate", "buffer", "view", "map", "module", "pipeline", "sets", "commands", "fence", "submit", "wait", "hang"};
  return names[std::size_t(call)];
}

VulkanFaults::VulkanFaults() {
  memory = buffers = 0;
  disarm();
  put<VulkanCall::allocate>(vkAllocateMemory);
  put<VulkanCall::buffer>(vkCreateBuffer);
  put<VulkanCall::view>(vkCreateBufferView);
  put<VulkanCall::map>(vkMapMemory);
  put<VulkanCall::module>(vkCreateShaderModule);
  put<VulkanCall::pipeline>(vkCreateComputePipelines);
  put<VulkanCall::sets>(vkAllocateDescriptorSets);
  put<VulkanCall::commands>(vkAllocateCommandBuffers);
  put<VulkanCall::fence>(vkCreateFence);
  put<VulkanCall::submit>(vkQueueSubmit);
  real_wait = vkWaitForFences;
  vkWaitForFences = wait_stand_in;
  real_free = vkFreeMemory;
  vkFreeMemory = free_stand_in;
  real_destroy = vkDestroyBuffer;
  vkDestroyBuffer = destroy_stand_in;
}

VulkanFaults::~VulkanFaults() {
  take_back<VulkanCall::allocate>(vkAllocateMemory);
  take_back<VulkanCall::buffer>(vkCreateBuffer);
  take_back<VulkanCall::view>(vkCreateBufferView);
  take_back<VulkanCall::map>(vkMapMemory);
  take_back<VulkanCall::module>(vkCreateShaderModule);
  take_back<VulkanCall::pipeline>(vkCreateComputePipelines);
  take_back<VulkanCall::sets>(vkAllocateDescriptorSets);
  take_back<VulkanCall::commands>(vkAllocateCommandBuffers);
  take_back<VulkanCall::fence>(vkCreateFence);
  take_back<VulkanCall::submit>(vkQueueSubmit);
  if (vkWaitForFences == wait_stand_in) vkWaitForFences = real_wait;
  if (vkFreeMemory == free_stand_in) vkFreeMemory = real_free;
  if (vkDestroyBuffer == destroy_stand_in) vkDestroyBuffer = real_destroy;
}

void VulkanFaults::arm(VulkanCall call, int n) {
  disarm();
  fails_at[std::size_t(call)] = n;
}

void VulkanFaults::disarm() {
  for (auto& seen : seen_calls) seen = 0;
  for (auto& at : fails_at) at = -1;
}

int VulkanFaults::seen(VulkanCall call) const {
  return seen_calls[std::size_t(call)];
}

int VulkanFaults::live_memory() const {
  return memory;
}

int VulkanFaults::live_buffers() const {
  return buffers;
}

} // namespace cowgpu::test
