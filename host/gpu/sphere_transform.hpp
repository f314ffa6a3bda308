// The Vulkan path of the verbs `analyse` and `synthesise`.
#pragma once

#include "engine/gpu.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

std::unique_ptr<SphereTransform> sphere_transform(engine::Gpu& gpu, const SphereGrid& grid, int lmax);
MemoryNeed sphere_transform_memory(const engine::GpuFacts& facts, const SphereGrid& grid, int lmax, int fields);

} // namespace cowgpu::gpu
