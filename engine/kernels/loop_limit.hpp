// The kernel loop_limit: how many iterations of a loop a device really runs.
#pragma once

#include "engine/gpu.hpp"

namespace cowgpu::engine {

/// Iterations that ran of a loop of `iterations`. Mesa's llvmpipe ends loops silently after 65535; every kernel here
/// stays below that by its iteration budget.
std::uint32_t loop_iterations(Device& device, std::uint32_t iterations);

} // namespace cowgpu::engine
