// The Vulkan path of the verb `closest`. The device lists the faces that may be the closest in single precision; among
// them the host decides with the code of the CPU path, so that both give the same bits. That leaves fp64 out of the shader
// and costs a tenth of the search: a query has two candidates, and its place on the face is found on the host anyway. So
// are signs: a ray is needed for few queries.
#pragma once

#include "engine/gpu.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// Keeps the device open. `iteration_budget`: GpuOptions::iteration_budget. Throws engine::Error beside Error.
std::unique_ptr<DistanceField> distance_field(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                                              std::span<const Vec3> vertices, std::span<const Face> faces);

MemoryNeed distance_field_memory(std::uint64_t vertices, std::uint64_t faces, std::uint64_t queries);

} // namespace cowgpu::gpu
