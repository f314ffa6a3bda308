// The engine's front door: a device of this machine, without a Vulkan type in sight.
#pragma once

#include "engine/error.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace cowgpu::engine {

class Device;

/// What a device is and can do.
struct GpuFacts {
  std::string name;
  std::string type; ///< "discrete", "integrated", "virtual", "software" or "other"
  std::string driver;
  std::string api;     ///< "Vulkan 1.3.230"
  bool usable = false; ///< double precision, subgroup shuffles and a compute queue
  bool fp64 = false;
  std::uint32_t subgroup_size = 1;
  std::uint32_t shared_memory = 0; ///< bytes
  std::uint64_t memory = 0;        ///< bytes of the largest device-local heap
  std::uint64_t largest_range = 0; ///< bytes one binding may span
  std::uint64_t largest_allocation = 0;
  std::uint64_t largest_texels = 0; ///< elements of a texel buffer
};

/// Devices of this machine, best first. Throws Error(no_loader), Error(no_device), Error(vulkan).
std::vector<GpuFacts> list_gpus();

/// Time of one kernel on the device.
struct KernelSeconds {
  std::string kernel;
  std::uint64_t dispatches = 0;
  double seconds = 0;
};

/// Called between batches with the fraction done; returns false to stop, which throws Error(stopped).
using Hook = std::function<bool(double)>;

/// One opened device.
class Gpu {
public:
  /// `wanted`: "auto", an index into list_gpus(), or a part of a name. `validation` switches on the core and
  /// synchronisation checks of the validation layer. Throws Error(no_loader, no_device, no_fp64, vulkan).
  explicit Gpu(const std::string& wanted, bool validation = false);
  ~Gpu();
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  const GpuFacts& facts() const { return facts_; }
  Device& device() { return *device_; }

  /// Messages of the validation layer so far.
  std::vector<std::string> validation_messages() const;
  /// Times since the last call.
  std::vector<KernelSeconds> take_profile();

private:
  std::unique_ptr<Device> device_;
  GpuFacts facts_;
};

/// While one lives, waits for the device ask `stop`. True: the caller wants to stop, which throws Error(stopped) between two
/// batches, or after five seconds where a batch does not end.
class StopScope {
public:
  StopScope(Gpu& gpu, std::function<bool()> stop);
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

private:
  Device& device_;
  std::function<bool()> before_;
};

} // namespace cowgpu::engine
