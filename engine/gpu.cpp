#include "engine/gpu.hpp"

#include "engine/device.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace cowgpu::engine {
namespace {

GpuFacts facts_of(const PhysicalDevice& device) {
  GpuFacts facts;
  const VkPhysicalDeviceProperties& p = device.properties;
  facts.name = p.deviceName;
  facts.type = device.type_name();
  facts.driver = device.driver;
  facts.api = fmt::format("Vulkan {}.{}.{}", VK_API_VERSION_MAJOR(p.apiVersion), VK_API_VERSION_MINOR(p.apiVersion),
                          VK_API_VERSION_PATCH(p.apiVersion));
  facts.usable = device.usable();
  facts.fp64 = device.fp64;
  facts.subgroup_size = device.subgroup_size;
  facts.shared_memory = p.limits.maxComputeSharedMemorySize;
  facts.largest_range = p.limits.maxStorageBufferRange;
  facts.largest_allocation = device.largest_allocation;
  facts.largest_texels = p.limits.maxTexelBufferElements;
  for (std::uint32_t h = 0; h < device.memory.memoryHeapCount; ++h)
    if (device.memory.memoryHeaps[h].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
      facts.memory = std::max<std::uint64_t>(facts.memory, device.memory.memoryHeaps[h].size);
  return facts;
}

} // namespace

std::vector<GpuFacts> list_gpus() {
  std::vector<GpuFacts> list;
  for (const PhysicalDevice& device : Instance::create()->devices()) list.push_back(facts_of(device));
  return list;
}

Gpu::Gpu(const std::string& wanted, bool validation) {
  auto instance = Instance::create(validation);
  const auto devices = instance->devices();
  const PhysicalDevice& chosen = choose_device(devices, wanted);
  facts_ = facts_of(chosen);
  device_ = std::make_unique<Device>(std::move(instance), chosen);
}

Gpu::~Gpu() = default;

StopScope::StopScope(Gpu& gpu, std::function<bool()> stop)
    : device_(gpu.device()), before_(device_.set_stop(std::move(stop))) {}

StopScope::~StopScope() {
  device_.set_stop(std::move(before_));
}

std::vector<std::string> Gpu::validation_messages() const {
  ValidationLog& log = device_->log();
  const std::lock_guard lock(log.mutex);
  return log.messages;
}

std::vector<KernelSeconds> Gpu::take_profile() {
  std::vector<KernelSeconds> list;
  for (const auto& [name, entry] : device_->profile().kernels) list.push_back({name, entry.dispatches, entry.seconds});
  device_->profile().kernels.clear();
  return list;
}

} // namespace cowgpu::engine
