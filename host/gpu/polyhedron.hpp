// The Vulkan path of the verb `polyhedron`: faces in strips and groups of points from the host's plan, through the kernel.
#pragma once

#include "engine/gpu.hpp"
#include "engine/kernels/moments.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// Keeps the device open. `shape`: of the moments that points far away need. `iteration_budget`: GpuOptions::iteration_budget.
std::unique_ptr<PreparedPolyhedron> polyhedron(std::shared_ptr<engine::Gpu> gpu, const engine::MomentsShape& shape,
                                               std::uint32_t iteration_budget, const PolyhedronProblem& problem);

} // namespace cowgpu::gpu
