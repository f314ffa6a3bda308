// The Vulkan path of the verb `closest`: faces from the device (host/gpu/closest_faces.hpp), places on them and signs from
// the host, where a ray is needed for few queries. Both paths give the same bits.
#pragma once

#include "engine/gpu.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// Keeps the device open. `iteration_budget`: GpuOptions::iteration_budget.
std::unique_ptr<DistanceField> distance_field(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                                              std::span<const Vec3> vertices, std::span<const Face> faces);

} // namespace cowgpu::gpu
