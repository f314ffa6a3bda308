// A compute pipeline made from an embedded shader.
#pragma once

#include "engine/device.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cowgpu::engine {

/// How a shader sees a buffer. Texel buffers are read-only, and on software devices several times faster inside loops.
enum class BindingKind {
  storage,
  texel_double,  ///< usamplerBuffer, a double a texel (R32G32_UINT)
  texel_doubles, ///< usamplerBuffer, two doubles or four words a texel (R32G32B32A32_UINT)
};

/// What a kernel is made of.
struct KernelInfo {
  std::string name; ///< in errors and in the profile
  std::span<const std::uint32_t> spirv;
  std::uint32_t bindings = 0;           ///< buffers 0 ... bindings-1 of set 0
  std::uint32_t push_bytes = 0;         ///< size of push constants; at most 128
  std::vector<std::uint32_t> constants; ///< specialization constants with ids 0, 1, 2 ...
  std::vector<BindingKind> kinds = {};  ///< kinds of the first bindings; the others are storage buffers
};

VkDescriptorType descriptor_type(BindingKind kind);

/// A pipeline. The first specialization constant is the workgroup's width by the shaders' convention.
class Kernel {
public:
  /// Throws Error(vulkan); Error(out_of_range) for a workgroup wider than the device's.
  Kernel(Device& device, const KernelInfo& info);
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  const std::string& name() const { return name_; }
  VkPipeline pipeline() const { return pipeline_; }
  VkPipelineLayout layout() const { return layout_; }
  VkDescriptorSetLayout set_layout() const { return set_layout_; }
  std::uint32_t bindings() const { return bindings_; }
  BindingKind kind(std::uint32_t binding) const { return kinds_[binding]; }
  std::uint32_t push_bytes() const { return push_bytes_; }

private:
  void create(const KernelInfo& info);
  void release();

  Device& device_;
  std::string name_;
  std::uint32_t bindings_;
  std::vector<BindingKind> kinds_;
  std::uint32_t push_bytes_;
  VkShaderModule module_ = VK_NULL_HANDLE;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

} // namespace cowgpu::engine
