// A logical device with one compute queue.
#pragma once

#include "engine/instance.hpp"
#include "engine/profile.hpp"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace cowgpu::engine {

class Kernel;
struct KernelInfo;

/// How long a batch is waited for. It is bounded to well under a second of work; a minute without an end is a hang, and five
/// minutes of a software device, whose driver compiles a kernel when it first runs, beside whatever else the CPU does. Slices of
/// waiting are counted, not the clock: while the process is suspended, or the clock jumps, none is waited.
struct Patience {
  std::uint64_t slice_ns = 100'000'000;
  std::uint32_t slices = 600;    ///< after so many the device is given up as lost; 3000 of software devices
  std::uint32_t after_stop = 50; ///< after so many from a wish to stop on, and the device is given up too
};

/// Owns the VkDevice and the kernels made on it. Once the device is lost every further call throws Error(device_lost), and
/// what was made on it is left as it is, to the end of the process: shaders that still run may use it.
class Device {
public:
  /// Throws Error(no_fp64) for a device that cannot compute here, Error(vulkan).
  Device(std::shared_ptr<Instance> instance, const PhysicalDevice& physical);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkDevice handle() const { return handle_; }
  VkQueue queue() const { return queue_; }
  VkCommandPool command_pool() const { return command_pool_; }
  const PhysicalDevice& physical() const { return physical_; }
  const VkPhysicalDeviceLimits& limits() const { return physical_.properties.limits; }
  const std::string& name() const { return name_; }
  bool software() const { return physical_.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
  Profile& profile() { return profile_; }
  ValidationLog& log() { return instance_->log(); }

  /// The kernel of this name and these constants, made on first use and kept.
  const Kernel& kernel(const KernelInfo& info);

  /// Bytes one shader binding may span.
  std::uint64_t largest_range() const { return limits().maxStorageBufferRange; }

  /// Throws unless `result` is VK_SUCCESS; remembers a lost device. `what` is the action.
  void check(VkResult result, const std::string& what);

  /// Throws Error(device_lost) if the device was lost earlier.
  void check_alive() const;

  /// Nothing that was made on a lost device may be destroyed.
  bool lost() const { return lost_; }

  /// Waits for submitted work, `what`, that signals `fence`. Throws Error(device_lost) for a device that is lost or hangs,
  /// Error(stopped) where the caller wants to stop and the work does not end; the device is lost then.
  void wait(VkFence fence, const std::string& what);

  void set_patience(const Patience& patience) { patience_ = patience; }
  /// Asked after each slice of waiting; empty: never stops. Returns what was there before.
  std::function<bool()> set_stop(std::function<bool()> stop) { return std::exchange(stop_, std::move(stop)); }

  /// A memory type that has all of `wanted`, -1 if there is none among `allowed`.
  int memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const;

private:
  std::shared_ptr<Instance> instance_;
  PhysicalDevice physical_;
  std::string name_;
  VkDevice handle_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  VkCommandPool command_pool_ = VK_NULL_HANDLE;
  std::map<std::string, std::unique_ptr<Kernel>> kernels_;
  Profile profile_;
  Patience patience_;
  std::function<bool()> stop_;
  bool lost_ = false;
};

} // namespace cowgpu::engine
