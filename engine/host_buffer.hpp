// A buffer and its contents on the host.
#pragma once

#include "engine/buffer.hpp"

#include <algorithm>
#include <memory>
#include <vector>

namespace cowgpu::engine {

/// Where the device shares the host's memory host() is the buffer's own memory and send() and receive() do nothing;
/// elsewhere it is a copy that they move.
class HostBuffer {
public:
  HostBuffer(Device& device, std::uint64_t bytes, const std::string& what)
      : buffer_(std::make_unique<Buffer>(device, bytes, what)) {
    if (buffer_->mapped().empty()) copy_.resize(buffer_->size());
  }

  std::uint64_t size() const { return buffer_->size(); }
  const Buffer& buffer() const { return *buffer_; }
  template <class T>
  std::span<T> host() {
    const std::span<std::byte> bytes = copy_.empty() ? buffer_->mapped() : std::span(copy_);
    return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  /// Zeros on both sides.
  void clear() {
    std::fill(copy_.begin(), copy_.end(), std::byte(0));
    buffer_->clear();
  }
  void send() { buffer_->write(copy_); }
  void receive() { buffer_->read(copy_); }
  /// Sends, and gives the buffer alone: the host does not need it again.
  std::unique_ptr<Buffer> hand_over() {
    send();
    copy_ = {};
    return std::move(buffer_);
  }

private:
  std::unique_ptr<Buffer> buffer_;
  std::vector<std::byte> copy_;
};

} // namespace cowgpu::engine
