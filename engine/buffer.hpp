// A buffer for shaders, with its memory.
#pragma once

#include "engine/device.hpp"

#include <cstddef>
#include <map>
#include <span>
#include <tuple>

namespace cowgpu::engine {

/// Device memory shaders can bind. Where the device shares the host's memory it is mapped; elsewhere read() and write()
/// go through a staging buffer. Few and big: each one has an allocation of its own.
class Buffer {
public:
  /// `bytes` > 0, rounded up to 16. Throws Error(out_of_range) above the device's largest allocation, Error(vulkan) where
  /// memory is short; `what` names the buffer in messages.
  Buffer(Device& device, std::uint64_t bytes, std::string what);
  ~Buffer();
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  VkBuffer handle() const { return handle_; }
  std::uint64_t size() const { return size_; }

  /// Copies to or from bytes [offset, offset + data size). No job may use the buffer meanwhile.
  void write(std::span<const std::byte> data, std::uint64_t offset = 0);
  void read(std::span<std::byte> data, std::uint64_t offset = 0);
  /// Fills the buffer with zeros.
  void clear();
  /// The memory itself where it is mapped, else empty. No job may use the buffer while it is touched.
  std::span<std::byte> mapped() { return {mapped_, mapped_ ? size_ : 0}; }

  /// Bytes [offset, offset + bytes) as texels of `format`; made on first use and kept as long as the buffer.
  VkBufferView view(VkFormat format, std::uint64_t offset, std::uint64_t bytes) const;

private:
  enum class Place { device, staging };
  Buffer(Device& device, std::uint64_t bytes, std::string what, Place place);
  void allocate(Place place);
  void release();
  template <class Copy>
  void staged(std::uint64_t offset, std::uint64_t bytes, bool to_device, const Copy& copy);

  Device& device_;
  std::uint64_t size_;
  std::string what_;
  VkBuffer handle_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  std::byte* mapped_ = nullptr;
  mutable std::map<std::tuple<VkFormat, std::uint64_t, std::uint64_t>, VkBufferView> views_;
};

} // namespace cowgpu::engine
