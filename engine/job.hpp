// A batch of work for a device: recorded, submitted, waited for.
#pragma once

#include "engine/buffer.hpp"
#include "engine/kernel.hpp"

#include <span>
#include <vector>

namespace cowgpu::engine {

/// Bytes [offset, offset + size) of a buffer, as a shader sees them; size 0: to the end.
struct BufferRange {
  const Buffer* buffer = nullptr;
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
};

/// Records dispatches, copies and fills; each sees what the ones before it wrote. run() submits and waits. No other job may
/// run while one is being recorded (Buffer's read, write and clear may take one). Timestamps
/// around each dispatch go to the device's profile.
class Job {
public:
  explicit Job(Device& device);
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// `groups` workgroups of `kernel`. Throws Error(out_of_range) if a range or the number of groups is beyond the
  /// device's limits.
  void dispatch(const Kernel& kernel, std::span<const BufferRange> ranges, std::span<const std::byte> push,
                std::uint32_t groups);
  void copy(const Buffer& from, std::uint64_t from_offset, const Buffer& to, std::uint64_t to_offset,
            std::uint64_t bytes);
  void clear(const Buffer& buffer);

  /// Dispatches recorded since the last run().
  std::size_t dispatches() const { return recorded_.size(); }

  /// Submits what was recorded and waits for it; the job can then record anew. Throws Error(device_lost),
  /// Error(stopped), Error(vulkan).
  void run();

private:
  static constexpr std::uint32_t capacity = 64; // dispatches; dispatch() runs the job when it is full
  void begin();
  void barrier();
  void release();

  Device& device_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkQueryPool queries_ = VK_NULL_HANDLE;
  std::vector<std::string> recorded_; // kernel of each dispatch
  bool recording_ = false;
};

} // namespace cowgpu::engine
