// The Vulkan path of the verb `potential`: series and points from the host's plan, in batches through the kernel.
#pragma once

#include "engine/gpu.hpp"
#include "host/backend.hpp"

namespace cowgpu::gpu {

/// Throws engine::Error beside Error. `iteration_budget`: GpuOptions::iteration_budget.
PotentialField potential(engine::Gpu& gpu, std::uint32_t iteration_budget, const PotentialProblem& problem,
                         Monitor& monitor, RunReport* report);

MemoryNeed potential_memory(std::uint64_t points, int lmax, Derivatives derivatives);

} // namespace cowgpu::gpu
