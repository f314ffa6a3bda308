#include "engine/buffer.hpp"

#include "engine/job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace cowgpu::engine {
namespace {
constexpr std::uint64_t staging_bytes = std::uint64_t(16) << 20;
}

Buffer::Buffer(Device& device, std::uint64_t bytes, std::string what)
    : Buffer(device, bytes, std::move(what), Place::device) {}

Buffer::Buffer(Device& device, std::uint64_t bytes, std::string what, Place place)
    : device_(device), size_((std::max<std::uint64_t>(bytes, 1) + 15) / 16 * 16), what_(std::move(what)) {
  try {
    allocate(place);
  } catch (...) {
    release();
    throw;
  }
}

void Buffer::allocate(Place place) {
  device_.check_alive();
  const std::string action = fmt::format("allocate {:.1f} MiB for {}", double(size_) / (1 << 20), what_);
  if (device_.physical().largest_allocation && size_ > device_.physical().largest_allocation)
    throw Error(Failure::out_of_range, 0,
                fmt::format("the device {} cannot {}: its largest allocation is {:.1f} MiB; lower --lmax or use "
                            "--device cpu",
                            device_.name(), action, double(device_.physical().largest_allocation) / (1 << 20)));
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = size_;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
               VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  device_.check(vkCreateBuffer(device_.handle(), &info, nullptr, &handle_), action);
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device_.handle(), handle_, &needs);

  constexpr VkMemoryPropertyFlags visible = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  // Reading uncached memory is slow, so only cached memory counts as shared.
  constexpr VkMemoryPropertyFlags shared =
      VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | visible | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  int type = -1;
  bool map = true;
  if (place == Place::device) {
    type = device_.memory_type(needs.memoryTypeBits, shared);
    if (type < 0) {
      map = false;
      type = device_.memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    }
  } else {
    type = device_.memory_type(needs.memoryTypeBits, visible | VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
    if (type < 0) type = device_.memory_type(needs.memoryTypeBits, visible);
  }
  if (type < 0) device_.check(VK_ERROR_OUT_OF_DEVICE_MEMORY, action);
  VkMemoryAllocateInfo memory{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  memory.allocationSize = needs.size;
  memory.memoryTypeIndex = std::uint32_t(type);
  device_.check(vkAllocateMemory(device_.handle(), &memory, nullptr, &memory_), action);
  device_.check(vkBindBufferMemory(device_.handle(), handle_, memory_, 0), action);
  if (map) {
    void* address = nullptr;
    device_.check(vkMapMemory(device_.handle(), memory_, 0, VK_WHOLE_SIZE, 0, &address), action);
    mapped_ = static_cast<std::byte*>(address);
  }
}

VkBufferView Buffer::view(VkFormat format, std::uint64_t offset, std::uint64_t bytes) const {
  VkBufferView& kept = views_[{format, offset, bytes}];
  if (!kept) {
    VkBufferViewCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
    info.buffer = handle_;
    info.format = format;
    info.offset = offset;
    info.range = bytes;
    device_.check(vkCreateBufferView(device_.handle(), &info, nullptr, &kept), "make a texel view of " + what_);
  }
  return kept;
}

void Buffer::release() {
  if (device_.lost()) return;
  for (const auto& [key, view] : views_) vkDestroyBufferView(device_.handle(), view, nullptr);
  if (handle_) vkDestroyBuffer(device_.handle(), handle_, nullptr);
  if (memory_) vkFreeMemory(device_.handle(), memory_, nullptr);
}

Buffer::~Buffer() {
  release();
}

template <class Copy>
void Buffer::staged(std::uint64_t offset, std::uint64_t bytes, bool to_device, const Copy& copy) {
  Buffer staging(device_, std::min(bytes, staging_bytes), "staging", Place::staging);
  for (std::uint64_t done = 0; done < bytes;) {
    const std::uint64_t part = std::min(bytes - done, staging.size());
    if (to_device) copy(staging.mapped_, done, part);
    Job job(device_);
    if (to_device)
      job.copy(staging, 0, *this, offset + done, part);
    else
      job.copy(*this, offset + done, staging, 0, part);
    job.run();
    if (!to_device) copy(staging.mapped_, done, part);
    done += part;
  }
}

void Buffer::write(std::span<const std::byte> data, std::uint64_t offset) {
  if (data.empty()) return;
  if (mapped_) {
    std::memcpy(mapped_ + offset, data.data(), data.size());
    return;
  }
  staged(offset, data.size(), true,
         [&](std::byte* to, std::uint64_t at, std::uint64_t part) { std::memcpy(to, data.data() + at, part); });
}

void Buffer::read(std::span<std::byte> data, std::uint64_t offset) {
  if (data.empty()) return;
  if (mapped_) {
    std::memcpy(data.data(), mapped_ + offset, data.size());
    return;
  }
  staged(offset, data.size(), false, [&](const std::byte* from, std::uint64_t at, std::uint64_t part) {
    std::memcpy(data.data() + at, from, part);
  });
}

void Buffer::clear() {
  if (mapped_) {
    std::memset(mapped_, 0, size_);
    return;
  }
  Job job(device_);
  job.clear(*this);
  job.run();
}

} // namespace cowgpu::engine
