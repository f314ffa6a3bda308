// Vulkan path of the stage `sample`: spans and records from the plan, what the filter leaves open decided here.
#pragma once

#include "engine/gpu.hpp"
#include "host/backend.hpp"

namespace cowgpu::gpu {

/// Backend::sample on an opened device. Throws engine::Error beside Error.
SphereSamples sample(engine::Gpu& gpu, std::span<const Vec3> positions, std::span<const Face> faces,
                     const SphereGrid& grid, Monitor& monitor, RunReport* report);

MemoryNeed sample_memory(const engine::GpuFacts& facts, std::uint64_t faces, const SphereGrid& grid);

} // namespace cowgpu::gpu
