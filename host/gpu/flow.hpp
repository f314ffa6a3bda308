// The Vulkan path of the verb `flow`, in wavefronts. Up to most_live points are on their way at once. Each pass the device
// searches for the nearest faces of all of them (shaders/closest.comp) and advances each by one event to its next query
// (shaders/flow.comp), with the operations of the CPU path in the same order: both paths give the same bits. The host sorts
// the queries along a Morton curve, fills the places of those that ended with new starts and launches the next. Its share of
// a point's way is the beginning, which takes winding numbers, and queries the search gives up. What that costs stands in
// bench/flow.md.
#pragma once

#include "engine/gpu.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// Keeps the device open. `iteration_budget`: GpuOptions::iteration_budget.
std::unique_ptr<DistanceFlow> distance_flow(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                                            std::span<const Vec3> vertices, std::span<const Face> faces);

} // namespace cowgpu::gpu
