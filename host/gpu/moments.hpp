// Vulkan path of the stage `moments`: plans on the host, hands pairs to engine/kernels/moments.
#pragma once

#include "engine/kernels/moments.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// The parts of a layout that options fix.
engine::MomentsShape shape_from(const GpuOptions& options);

/// Backend::moments on an opened device, which is kept open.
std::unique_ptr<PreparedMoments> moments(std::shared_ptr<engine::Gpu> gpu, const engine::MomentsShape& shape,
                                         const MomentProblem& problem);

} // namespace cowgpu::gpu
