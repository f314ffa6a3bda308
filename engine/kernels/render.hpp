// The kernel render: the first triangle along each of many rays. The method stands in shaders/render.comp, its interface in
// shaders/render.h.
#pragma once

#include "engine/gpu.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>

namespace cowgpu::engine {

class Buffer;
class HostBuffer;
class Kernel;

/// A binary tree of boxes over triangles, as shaders/render.h lays it out.
struct RenderInput {
  std::span<const std::byte> nodes;       ///< 64 bytes each, the root first
  std::span<const std::byte> triangles;   ///< 80 bytes each, in the order of the leaves
  std::uint32_t iteration_budget = 60000; ///< loop iterations an invocation may run in one dispatch
};

struct RenderRay {
  double origin[3], direction[3], limit; ///< hits beyond limit * direction do not count
};

struct RenderHit {
  std::uint32_t face; ///< or one of the below
  std::uint32_t unused;
  double t, u, v; ///< hit = origin + t direction = (1 - u - v) a + u b + v c
};
inline constexpr std::uint32_t render_nothing = 0xffffffffU; ///< hits no triangle
inline constexpr std::uint32_t render_left = 0xfffffffeU;    ///< the device gave up: too many steps

/// A tree on a device.
class Render {
public:
  /// Throws Error(out_of_range) for a tree beyond the device's limits or with a budget that no search fits in;
  /// Error(vulkan), Error(device_lost).
  Render(Device& device, const RenderInput& input);
  ~Render();
  Render(const Render&) = delete;
  Render& operator=(const Render&) = delete;

  /// Rays of a batch: one dispatch.
  static constexpr std::uint32_t most_rays = 1U << 17;

  /// Room for most_rays rays.
  std::span<RenderRay> rays();
  /// Casts the first `count` of them. Throws Error(cut_short), Error(vulkan), Error(device_lost).
  std::span<const RenderHit> cast(std::uint32_t count);

  static std::uint64_t device_bytes(std::uint64_t nodes, std::uint64_t triangles);

private:
  Device& device_;
  const Kernel* kernel_;
  std::uint32_t steps_;
  std::unique_ptr<Buffer> nodes_, triangles_;
  std::unique_ptr<HostBuffer> rays_, hits_;
};

} // namespace cowgpu::engine
