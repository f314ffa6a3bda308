// The Vulkan path of the verbs `analyse` and `synthesise`: plans and the series' ends on the host, the stages ring_fourier
// and legendre in engine/kernels.
#pragma once

#include "engine/kernels/sphere_transform.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// The parts of a layout that options fix.
engine::SphereTransformShape transform_shape_from(const GpuOptions& options);

/// What is made keeps the device open.
std::unique_ptr<SphereTransform> sphere_transform(std::shared_ptr<engine::Gpu> gpu,
                                                  const engine::SphereTransformShape& shape, const SphereGrid& grid,
                                                  int lmax);

} // namespace cowgpu::gpu
