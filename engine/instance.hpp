// The Vulkan instance and what it finds on this machine.
#pragma once

#include "engine/vulkan.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace cowgpu::engine {

/// Messages the validation layers gave. Shared by everything made from one instance.
struct ValidationLog {
  std::mutex mutex;
  std::vector<std::string> messages;
};

/// A physical device with the facts a choice is made by.
struct PhysicalDevice {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  std::string driver; ///< name and version, in words
  bool fp64 = false;
  bool subgroup_arithmetic = false; ///< subgroup shuffles in compute shaders
  std::uint32_t subgroup_size = 1;
  std::uint64_t largest_allocation = 0;
  int queue_family = -1; ///< one that computes; -1: none

  bool usable() const { return fp64 && subgroup_arithmetic && queue_family >= 0; }
  const char* type_name() const; ///< "discrete", "integrated", "virtual", "software" or "other"
};

/// A VkInstance. Destroyed last: devices hold a shared pointer to it.
class Instance {
public:
  /// Throws Error(no_loader) where there is no libvulkan, Error(vulkan) where an instance cannot be made. `validation`
  /// switches on core and synchronisation validation; Error(vulkan) if the layer is not installed.
  static std::shared_ptr<Instance> create(bool validation = false);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  VkInstance handle() const { return handle_; }
  ValidationLog& log() { return log_; }

  /// All devices: discrete, integrated, virtual, software, others; in the driver's order within a type.
  std::vector<PhysicalDevice> devices() const;

private:
  Instance() = default;
  VkInstance handle_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger_ = nullptr;
  ValidationLog log_;
};

/// Picks a device: "auto" (the first usable one), an index into `devices`, or a part of a name, case not counted. Throws
/// Error(no_device) or Error(no_fp64), naming what there is.
const PhysicalDevice& choose_device(const std::vector<PhysicalDevice>& devices, const std::string& wanted);

} // namespace cowgpu::engine
