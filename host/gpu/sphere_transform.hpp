// The Vulkan path of the verbs `analyse` and `synthesise`: plans and the series' ends on the host, the stages ring_fourier
// and legendre in engine/kernels.
#pragma once

#include "engine/kernels/sphere_transform.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// The parts of a layout that options fix.
engine::SphereTransformShape transform_shape_from(const GpuOptions& options);

/// `gpu` must outlive what is made.
std::unique_ptr<SphereTransform> sphere_transform(engine::Gpu& gpu, const engine::SphereTransformShape& shape,
                                                  const SphereGrid& grid, int lmax);

/// Host: the plan with its start values, which are given up once they are on the device. Device: see
/// engine::sphere_transform_device_bytes().
MemoryNeed sphere_transform_memory(const engine::GpuFacts& facts, const engine::SphereTransformShape& shape,
                                   const SphereGrid& grid, int lmax, int fields);

} // namespace cowgpu::gpu
