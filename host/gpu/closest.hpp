// The Vulkan path of the verb `closest`. The device lists the faces that may be the closest in single precision; among
// them the host decides with the code of the CPU path, so that both give the same bits. A query has about one candidate:
// deciding costs 7 % of the search on lavapipe and leaves fp64 out of the shader, and places on the faces are found on the
// host anyway. So are signs, as few queries need a ray. Searches the device gives up (too many steps or candidates), and
// queries too far away for single precision, are the host's as well.
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
