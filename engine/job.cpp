#include "engine/job.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>

namespace cowgpu::engine {
namespace {
constexpr std::uint32_t most_bindings = 8;
} // namespace

Job::Job(Device& device) : device_(device) {
  device_.check_alive();
  try {
    VkCommandBufferAllocateInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    commands.commandPool = device_.command_pool();
    commands.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    commands.commandBufferCount = 1;
    device_.check(vkAllocateCommandBuffers(device_.handle(), &commands, &commands_), "make a command buffer");
    VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    device_.check(vkCreateFence(device_.handle(), &fence, nullptr, &fence_), "make a fence");
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, capacity * most_bindings},
                                          {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, capacity * most_bindings}};
    VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    pool.maxSets = capacity;
    pool.poolSizeCount = std::size(sizes);
    pool.pPoolSizes = sizes;
    device_.check(vkCreateDescriptorPool(device_.handle(), &pool, nullptr, &pool_), "make a descriptor pool");
    VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = 2 * capacity;
    device_.check(vkCreateQueryPool(device_.handle(), &queries, nullptr, &queries_), "make a query pool");
  } catch (...) {
    release();
    throw;
  }
}

void Job::release() {
  if (device_.lost()) return;
  vkDestroyQueryPool(device_.handle(), queries_, nullptr);
  vkDestroyDescriptorPool(device_.handle(), pool_, nullptr);
  vkDestroyFence(device_.handle(), fence_, nullptr);
  if (commands_) vkFreeCommandBuffers(device_.handle(), device_.command_pool(), 1, &commands_);
}

Job::~Job() {
  release();
}

void Job::begin() {
  if (recording_) return;
  device_.check_alive();
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  device_.check(vkBeginCommandBuffer(commands_, &begin), "record commands");
  vkCmdResetQueryPool(commands_, queries_, 0, 2 * capacity);
  recording_ = true;
}

void Job::barrier() {
  VkMemoryBarrier memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
  memory.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
  memory.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT |
                         VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_HOST_READ_BIT;
  vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                       VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT |
                           VK_PIPELINE_STAGE_HOST_BIT,
                       0, 1, &memory, 0, nullptr, 0, nullptr);
}

void Job::dispatch(const Kernel& kernel, std::span<const BufferRange> ranges, std::span<const std::byte> push,
                   std::uint32_t groups) {
  if (ranges.size() != kernel.bindings() || ranges.size() > most_bindings || push.size() != kernel.push_bytes())
    throw Error(Failure::out_of_range, 0,
                fmt::format("the kernel {} was given other arguments than it takes", kernel.name()));
  if (groups == 0) return;
  if (groups > device_.limits().maxComputeWorkGroupCount[0])
    throw Error(
        Failure::out_of_range, 0,
        fmt::format("{} workgroups of {} are more than the device {} takes", groups, kernel.name(), device_.name()));
  if (recorded_.size() == capacity) run();
  begin();

  VkDescriptorSet set = VK_NULL_HANDLE;
  const VkDescriptorSetLayout layout = kernel.set_layout();
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool_;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &layout;
  device_.check(vkAllocateDescriptorSets(device_.handle(), &allocate, &set), "make a descriptor set");
  std::array<VkDescriptorBufferInfo, most_bindings> buffers{};
  std::array<VkBufferView, most_bindings> views{};
  std::array<VkWriteDescriptorSet, most_bindings> writes{};
  for (std::uint32_t b = 0; b < ranges.size(); ++b) {
    const BufferRange& range = ranges[b];
    const std::uint64_t size = range.size ? range.size : range.buffer->size() - range.offset;
    const bool texels = kernel.kind(b) != BindingKind::storage;
    const std::uint64_t texel_bytes = kernel.kind(b) == BindingKind::texel_double ? 8 : 16;
    const std::uint64_t most = texels ? texel_bytes * device_.limits().maxTexelBufferElements : device_.largest_range();
    if (range.offset + size > range.buffer->size() || size > most)
      throw Error(Failure::out_of_range, 0,
                  fmt::format("binding {} of {} spans {} bytes; the device {} takes {}", b, kernel.name(), size,
                              device_.name(), most));
    buffers[b] = {range.buffer->handle(), range.offset, size};
    if (texels)
      views[b] = range.buffer->view(texel_bytes == 8 ? VK_FORMAT_R32G32_UINT : VK_FORMAT_R32G32B32A32_UINT,
                                    range.offset, size);
    writes[b] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    writes[b].dstSet = set;
    writes[b].dstBinding = b;
    writes[b].descriptorCount = 1;
    writes[b].descriptorType = descriptor_type(kernel.kind(b));
    writes[b].pBufferInfo = &buffers[b];
    writes[b].pTexelBufferView = &views[b];
  }
  vkUpdateDescriptorSets(device_.handle(), std::uint32_t(ranges.size()), writes.data(), 0, nullptr);

  const auto query = std::uint32_t(2 * recorded_.size());
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline());
  vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout(), 0, 1, &set, 0, nullptr);
  if (!push.empty())
    vkCmdPushConstants(commands_, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, std::uint32_t(push.size()),
                       push.data());
  vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, queries_, query);
  vkCmdDispatch(commands_, groups, 1, 1);
  vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, query + 1);
  barrier();
  recorded_.push_back(kernel.name());
}

void Job::copy(const Buffer& from, std::uint64_t from_offset, const Buffer& to, std::uint64_t to_offset,
               std::uint64_t bytes) {
  begin();
  const VkBufferCopy region = {from_offset, to_offset, bytes};
  vkCmdCopyBuffer(commands_, from.handle(), to.handle(), 1, &region);
  barrier();
}

void Job::clear(const Buffer& buffer) {
  begin();
  vkCmdFillBuffer(commands_, buffer.handle(), 0, VK_WHOLE_SIZE, 0);
  barrier();
}

void Job::run() {
  if (!recording_) return;
  recording_ = false;
  device_.check(vkEndCommandBuffer(commands_), "end a command buffer");
  VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands_;
  const std::string what =
      recorded_.empty() ? "copy" : fmt::format("run {} ({} dispatches)", recorded_.back(), recorded_.size());
  device_.check(vkQueueSubmit(device_.queue(), 1, &submit, fence_), what);
  device_.wait(fence_, what);
  device_.check(vkResetFences(device_.handle(), 1, &fence_), "reset a fence");

  std::vector<std::uint64_t> ticks(2 * recorded_.size());
  if (!ticks.empty() && vkGetQueryPoolResults(device_.handle(), queries_, 0, std::uint32_t(ticks.size()),
                                              ticks.size() * 8, ticks.data(), 8, VK_QUERY_RESULT_64_BIT) == VK_SUCCESS)
    for (std::size_t i = 0; i < recorded_.size(); ++i) {
      Profile::Entry& entry = device_.profile().kernels[recorded_[i]];
      ++entry.dispatches;
      entry.seconds += double(ticks[2 * i + 1] - ticks[2 * i]) * double(device_.limits().timestampPeriod) * 1e-9;
    }
  recorded_.clear();
  device_.check(vkResetDescriptorPool(device_.handle(), pool_, 0), "reset a descriptor pool");
  device_.check(vkResetCommandPool(device_.handle(), device_.command_pool(), 0), "reset a command pool");
}

} // namespace cowgpu::engine
