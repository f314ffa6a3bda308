#include "engine/kernel.hpp"

#include <fmt/format.h>

namespace cowgpu::engine {

VkDescriptorType descriptor_type(BindingKind kind) {
  return kind == BindingKind::storage ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
}

Kernel::Kernel(Device& device, const KernelInfo& info)
    : device_(device), name_(info.name), bindings_(info.bindings), kinds_(info.kinds), push_bytes_(info.push_bytes) {
  kinds_.resize(bindings_, BindingKind::storage);
  try {
    create(info);
  } catch (...) {
    release();
    throw;
  }
}

void Kernel::create(const KernelInfo& info) {
  device_.check_alive();
  const std::string action = fmt::format("make the kernel {}", name_);
  if (!info.constants.empty() && (info.constants[0] > device_.limits().maxComputeWorkGroupInvocations ||
                                  info.constants[0] > device_.limits().maxComputeWorkGroupSize[0]))
    throw Error(Failure::out_of_range, 0,
                fmt::format("the device {} cannot {}: {} invocations a workgroup are more than its {}", device_.name(),
                            action, info.constants[0], device_.limits().maxComputeWorkGroupInvocations));
  VkShaderModuleCreateInfo module{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  module.codeSize = info.spirv.size_bytes();
  module.pCode = info.spirv.data();
  device_.check(vkCreateShaderModule(device_.handle(), &module, nullptr, &module_), action);

  std::vector<VkDescriptorSetLayoutBinding> slots(bindings_);
  for (std::uint32_t b = 0; b < bindings_; ++b)
    slots[b] = {b, descriptor_type(kinds_[b]), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set.bindingCount = bindings_;
  set.pBindings = slots.data();
  device_.check(vkCreateDescriptorSetLayout(device_.handle(), &set, nullptr, &set_layout_), action);

  const VkPushConstantRange push = {VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes_};
  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &set_layout_;
  layout.pushConstantRangeCount = push_bytes_ ? 1 : 0;
  layout.pPushConstantRanges = &push;
  device_.check(vkCreatePipelineLayout(device_.handle(), &layout, nullptr, &layout_), action);

  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < info.constants.size(); ++i) entries.push_back({i, i * 4, 4});
  const VkSpecializationInfo constants = {std::uint32_t(entries.size()), entries.data(), info.constants.size() * 4,
                                          info.constants.data()};
  VkComputePipelineCreateInfo pipeline{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  pipeline.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  pipeline.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  pipeline.stage.module = module_;
  pipeline.stage.pName = "main";
  pipeline.stage.pSpecializationInfo = &constants;
  pipeline.layout = layout_;
  device_.check(vkCreateComputePipelines(device_.handle(), VK_NULL_HANDLE, 1, &pipeline, nullptr, &pipeline_), action);
}

void Kernel::release() {
  if (device_.lost()) return;
  vkDestroyPipeline(device_.handle(), pipeline_, nullptr);
  vkDestroyPipelineLayout(device_.handle(), layout_, nullptr);
  vkDestroyDescriptorSetLayout(device_.handle(), set_layout_, nullptr);
  vkDestroyShaderModule(device_.handle(), module_, nullptr);
}

Kernel::~Kernel() {
  release();
}

} // namespace cowgpu::engine
