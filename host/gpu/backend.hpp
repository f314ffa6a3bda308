// The Vulkan path on a device that several backends share, as the tests do.
#pragma once

#include "engine/gpu.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// Throws Error(bad_argument) for options that no kernel has (GpuOptions says the ranges).
void check(const GpuOptions& options);

/// The device that the options name. Throws Error(no_loader, no_device, no_fp64, device_failed).
std::shared_ptr<engine::Gpu> open_gpu(const GpuOptions& options);

/// The Vulkan path on `gpu`, which keeps the kernels that any of its backends made; `options` are those of their layout. Throws
/// what check() throws, Error(device_failed).
std::unique_ptr<Backend> make_backend(std::shared_ptr<engine::Gpu> gpu, const GpuOptions& options);

} // namespace cowgpu::gpu
