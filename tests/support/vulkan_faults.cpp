#include "tests/support/vulkan_faults.hpp"

#include <volk.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <map>
#include <mutex>
#include <tuple>

namespace cowgpu::test {
namespace {

constexpr std::array<VkResult, vulkan_calls> results = {
    VK_ERROR_OUT_OF_DEVICE_MEMORY, VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_HOST_MEMORY,
    VK_ERROR_MEMORY_MAP_FAILED,    VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_HOST_MEMORY,
    VK_ERROR_OUT_OF_POOL_MEMORY,   VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_DEVICE_MEMORY,
    VK_ERROR_DEVICE_LOST,          VK_ERROR_DEVICE_LOST,        VK_TIMEOUT};

std::array<std::atomic<int>, vulkan_calls> seen_calls, fails_at, fails_until;
std::atomic<int> memory = 0, buffers = 0, destroyed = 0;
std::atomic<bool> failed = false;

// Bytes of each allocation that lives.
std::mutex sizes_mutex;
std::map<VkDeviceMemory, std::uint64_t> sizes;
std::uint64_t live_bytes = 0, most_live_bytes = 0;

void count_allocation(const VkMemoryAllocateInfo* info, VkDeviceMemory handle) {
  const std::lock_guard lock(sizes_mutex);
  sizes[handle] = info->allocationSize;
  live_bytes += info->allocationSize;
  most_live_bytes = std::max(most_live_bytes, live_bytes);
}

void count_free(VkDeviceMemory handle) {
  const std::lock_guard lock(sizes_mutex);
  const auto found = sizes.find(handle);
  if (found == sizes.end()) return;
  live_bytes -= found->second;
  sizes.erase(found);
}

bool fails(VulkanCall call) {
  const auto c = std::size_t(call);
  const int n = seen_calls[c]++;
  if (n < fails_at[c] || n >= fails_until[c]) return false;
  failed = true;
  return true;
}

// One of the pointers, and what stands in its place.
template <VulkanCall call, class... Arguments>
struct Hook {
  using Function = VkResult(VKAPI_PTR*)(Arguments...);
  static inline Function real = nullptr;
  static VKAPI_ATTR VkResult VKAPI_CALL stand_in(Arguments... arguments) {
    if (fails(call)) return results[std::size_t(call)];
    const VkResult result = real(arguments...);
    if constexpr (call == VulkanCall::allocate)
      if (result == VK_SUCCESS) {
        ++memory;
        const std::tuple<Arguments...> all(arguments...);
        count_allocation(std::get<1>(all), *std::get<3>(all));
      }
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
PFN_vkDestroyFence real_destroy_fence;
PFN_vkDestroyPipeline real_destroy_pipeline;
PFN_vkDestroyDevice real_destroy_device;

// The work is over when the loss is told, so that what is done wrong then is found by these tests and not by a crash.
VKAPI_ATTR VkResult VKAPI_CALL wait_stand_in(VkDevice device, std::uint32_t count, const VkFence* fences, VkBool32 all,
                                             std::uint64_t timeout) {
  const VkResult result = real_wait(device, count, fences, all, timeout);
  if (result == VK_TIMEOUT) return result; // a slice of a longer wait
  if (fails(VulkanCall::wait)) return results[std::size_t(VulkanCall::wait)];
  if (fails(VulkanCall::hang)) return results[std::size_t(VulkanCall::hang)];
  return result;
}

VKAPI_ATTR void VKAPI_CALL free_stand_in(VkDevice device, VkDeviceMemory handle,
                                         const VkAllocationCallbacks* callbacks) {
  if (handle) --memory;
  count_free(handle);
  destroyed += handle && failed;
  real_free(device, handle, callbacks);
}

VKAPI_ATTR void VKAPI_CALL destroy_stand_in(VkDevice device, VkBuffer handle, const VkAllocationCallbacks* callbacks) {
  if (handle) --buffers;
  destroyed += handle && failed;
  real_destroy(device, handle, callbacks);
}

VKAPI_ATTR void VKAPI_CALL fence_stand_in(VkDevice device, VkFence handle, const VkAllocationCallbacks* callbacks) {
  destroyed += handle && failed;
  real_destroy_fence(device, handle, callbacks);
}

VKAPI_ATTR void VKAPI_CALL pipeline_stand_in(VkDevice device, VkPipeline handle,
                                             const VkAllocationCallbacks* callbacks) {
  destroyed += handle && failed;
  real_destroy_pipeline(device, handle, callbacks);
}

VKAPI_ATTR void VKAPI_CALL device_stand_in(VkDevice device, const VkAllocationCallbacks* callbacks) {
  destroyed += failed;
  real_destroy_device(device, callbacks);
}

template <class Function>
void put_destroyer(Function& slot, Function& real, Function stand_in) {
  real = slot;
  slot = stand_in;
}

template <class Function>
void take_back_destroyer(Function& slot, Function real, Function stand_in) {
  if (slot == stand_in) slot = real;
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
  put_destroyer(vkFreeMemory, real_free, free_stand_in);
  put_destroyer(vkDestroyBuffer, real_destroy, destroy_stand_in);
  put_destroyer(vkDestroyFence, real_destroy_fence, fence_stand_in);
  put_destroyer(vkDestroyPipeline, real_destroy_pipeline, pipeline_stand_in);
  put_destroyer(vkDestroyDevice, real_destroy_device, device_stand_in);
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
  take_back_destroyer(vkFreeMemory, real_free, free_stand_in);
  take_back_destroyer(vkDestroyBuffer, real_destroy, destroy_stand_in);
  take_back_destroyer(vkDestroyFence, real_destroy_fence, fence_stand_in);
  take_back_destroyer(vkDestroyPipeline, real_destroy_pipeline, pipeline_stand_in);
  take_back_destroyer(vkDestroyDevice, real_destroy_device, device_stand_in);
}

void VulkanFaults::arm(VulkanCall call, int n, int times) {
  disarm();
  failed = false;
  destroyed = 0;
  fails_at[std::size_t(call)] = n;
  fails_until[std::size_t(call)] =
      times > std::numeric_limits<int>::max() - n ? std::numeric_limits<int>::max() : n + times;
}

void VulkanFaults::disarm() {
  {
    const std::lock_guard lock(sizes_mutex);
    most_live_bytes = live_bytes;
  }
  for (auto* list : {&seen_calls, &fails_at, &fails_until})
    for (auto& number : *list) number = 0;
}

int VulkanFaults::destroyed_since() const {
  return destroyed;
}

int VulkanFaults::seen(VulkanCall call) const {
  return seen_calls[std::size_t(call)];
}

int VulkanFaults::live_memory() const {
  return memory;
}

std::uint64_t VulkanFaults::most_bytes() const {
  const std::lock_guard lock(sizes_mutex);
  return most_live_bytes;
}

int VulkanFaults::live_buffers() const {
  return buffers;
}

} // namespace cowgpu::test
