// The Vulkan path of the verb `polyhedron`: faces in strips and groups of points from the host's plan, through the kernel.
#pragma once

#include "engine/gpu.hpp"
#include "engine/kernels/moments.hpp"
#include "host/backend.hpp"

#include <memory>

namespace cowgpu::gpu {

/// A point's sums of the device, `from_stride` apart, to those of PolyhedronRows.
void take_sums(const double* from, std::size_t from_stride, std::size_t rows, double* to, std::size_t to_stride);

/// How a device sums.
struct PolyhedronLayout {
  engine::MomentsShape moments;           ///< layout of the moments that points far away need
  std::uint32_t iteration_budget = 60000; ///< GpuOptions::iteration_budget
  bool translations = false;              ///< GpuOptions::translations
};

/// Keeps the device open; the fast sum where that takes less time.
std::unique_ptr<PreparedPolyhedron> polyhedron(std::shared_ptr<engine::Gpu> gpu, const PolyhedronLayout& layout,
                                               const PolyhedronProblem& problem);

} // namespace cowgpu::gpu
