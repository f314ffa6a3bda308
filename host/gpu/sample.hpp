// Vulkan path of the stage `sample`: spans and records from the plan, what the filter leaves open decided here.
#pragma once

#include "engine/gpu.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// Backend::sphere_sampler on an opened device, which is kept open.
std::unique_ptr<SphereSampler> sphere_sampler(std::shared_ptr<engine::Gpu> gpu, const SphereGrid& grid);

} // namespace cowgpu::gpu
