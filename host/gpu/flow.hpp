// The Vulkan path of the verb `flow`, in wavefronts. Up to most_live points are on their way at once. Each pass the device
// searches for the nearest faces of all of them (host/gpu/closest_faces.hpp); the host takes each point on to its next query
// with the code of the CPU path (host/cpu/flow_path.hpp), fills the places of those that ended with new starts and launches
// the next. The answers are the CPU path's, so both paths give the same bits. What the device does, what it does not and
// what that costs stands in bench/flow.md.
#pragma once

#include "engine/gpu.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// Keeps the device open. `iteration_budget`: GpuOptions::iteration_budget. Throws engine::Error beside Error.
std::unique_ptr<DistanceFlow> distance_flow(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                                            std::span<const Vec3> vertices, std::span<const Face> faces);

MemoryNeed distance_flow_memory(std::uint64_t vertices, std::uint64_t faces, std::uint64_t starts);

} // namespace cowgpu::gpu
