#include "engine/device.hpp"

#include "engine/kernel.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace cowgpu::engine {

Device::Device(std::shared_ptr<Instance> instance, const PhysicalDevice& physical)
    : instance_(std::move(instance)), physical_(physical), name_(physical.properties.deviceName) {
  if (!physical.usable())
    throw Error(Failure::no_fp64, 0,
                fmt::format("the device {} lacks double precision, subgroup shuffles or a compute queue", name_));
  if (software()) patience_.slices = 3000;
  const float priority = 1;
  VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue.queueFamilyIndex = std::uint32_t(physical.queue_family);
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkPhysicalDeviceFeatures features{};
  features.shaderFloat64 = VK_TRUE;
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.pEnabledFeatures = &features;
  check(vkCreateDevice(physical.handle, &info, nullptr, &handle_), "open the device");
  vkGetDeviceQueue(handle_, std::uint32_t(physical.queue_family), 0, &queue_);
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.queueFamilyIndex = std::uint32_t(physical.queue_family);
  const VkResult result = vkCreateCommandPool(handle_, &pool, nullptr, &command_pool_);
  if (result != VK_SUCCESS) {
    vkDestroyDevice(handle_, nullptr);
    check(result, "make a command pool");
  }
}

Device::~Device() {
  if (lost_) {
    kernels_.clear(); // kernels leave what they made on a lost device
    // The instance, and its log that the validation layer writes to, live as long as the device: to the end of the process.
    static auto* const left = new std::vector<std::shared_ptr<Instance>>;
    left->push_back(std::move(instance_));
    return;
  }
  kernels_.clear();
  vkDestroyCommandPool(handle_, command_pool_, nullptr);
  vkDestroyDevice(handle_, nullptr);
}

const Kernel& Device::kernel(const KernelInfo& info) {
  auto& kept = kernels_[fmt::format("{} {}", info.name, fmt::join(info.constants, " "))];
  if (!kept) kept = std::make_unique<Kernel>(*this, info);
  return *kept;
}

void Device::check(VkResult result, const std::string& what) {
  if (result == VK_SUCCESS) return;
  lost_ = lost_ || result == VK_ERROR_DEVICE_LOST;
  const Failure failure = lost_ ? Failure::device_lost : Failure::vulkan;
  throw Error(failure, result,
              fmt::format("the device {} could not {}: {}; try --device cpu{}", name_, what, describe_result(result),
                          lost_ ? "; the device is lost and nothing more is run on it" : ""));
}

void Device::check_alive() const {
  if (lost_)
    throw Error(Failure::device_lost, VK_ERROR_DEVICE_LOST,
                fmt::format("the device {} was lost earlier; nothing more is run on it; try --device cpu", name_));
}

void Device::wait(VkFence fence, const std::string& what) {
  std::uint32_t waited = 0, unheeded = 0;
  for (;;) {
    const VkResult result = vkWaitForFences(handle_, 1, &fence, VK_TRUE, patience_.slice_ns);
    if (result == VK_SUCCESS) return;
    if (result != VK_TIMEOUT) {
      lost_ = true; // whatever the reason, the work may go on
      check(result, what);
    }
    ++waited;
    if (stop_ && stop_()) {
      ++unheeded;
      if (unheeded < patience_.after_stop) continue;
      lost_ = true;
      throw Error(Failure::stopped, result,
                  fmt::format("stopped while the device {} did not end what it was given ({}); it is left to itself",
                              name_, what));
    }
    if (waited < patience_.slices) continue;
    lost_ = true;
    throw Error(Failure::device_lost, result,
                fmt::format("the device {} hangs: it could not {} while {:.0f} s were waited for it, where a second "
                            "suffices; it is given up as lost and nothing more is run on it; try --device cpu",
                            name_, what, double(patience_.slices) * double(patience_.slice_ns) * 1e-9));
  }
}

int Device::memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const {
  for (std::uint32_t i = 0; i < physical_.memory.memoryTypeCount; ++i)
    if ((allowed >> i & 1U) && (physical_.memory.memoryTypes[i].propertyFlags & wanted) == wanted) return int(i);
  return -1;
}

} // namespace cowgpu::engine
