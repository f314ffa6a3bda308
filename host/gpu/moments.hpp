// Vulkan path of the stage `moments`: plans on the host, hands pairs to engine/kernels/moments.
#pragma once

#include "engine/kernels/moments.hpp"
#include "host/backend.hpp"

namespace cowgpu::gpu {

/// The parts of a layout that options fix.
engine::MomentsShape shape_from(const GpuOptions& options);

/// Backend::moments on an opened device. Throws engine::Error beside Error.
Multipoles moments(engine::Gpu& gpu, const engine::MomentsShape& shape, const MomentProblem& problem, Monitor& monitor,
                   RunReport* report);

/// Host: the plan, 128 bytes a pair and 48 a coefficient. Device: see engine::moments_device_bytes().
MemoryNeed moments_memory(const engine::GpuFacts& facts, const engine::MomentsShape& shape,
                          const MomentProblem& problem);

} // namespace cowgpu::gpu
