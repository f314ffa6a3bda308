// Vulkan path of the stage `render`: the device casts the rays of some tiles at a time, step by step; what they are and what
// they say is host/plan/render.hpp's.
#pragma once

#include "engine/gpu.hpp"
#include "host/image.hpp"
#include "host/monitor.hpp"
#include "host/render.hpp"

namespace cowgpu::gpu {

/// Backend::render on an opened device. Throws engine::Error beside Error. Memory on the device: 160 bytes a face of the
/// largest panel, and 12 MB for rays.
Image render(engine::Gpu& gpu, std::uint32_t iteration_budget, const RenderScene& scene, Monitor& monitor);

} // namespace cowgpu::gpu
