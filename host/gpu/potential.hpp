// The Vulkan path of the verb `potential`: series and points from the host's plan, in batches through the kernel.
#pragma once

#include "engine/gpu.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// Keeps the device open. `iteration_budget`: GpuOptions::iteration_budget.
std::unique_ptr<ExteriorPotential> exterior_potential(std::shared_ptr<engine::Gpu> gpu, std::uint32_t iteration_budget,
                                                      const PotentialProblem& problem);

} // namespace cowgpu::gpu
