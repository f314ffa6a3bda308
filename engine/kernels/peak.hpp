// The kernel peak: what a device can do at most.
#pragma once

#include "engine/gpu.hpp"

namespace cowgpu::engine {

/// Measured double-precision multiply-add throughput, in flops per second (a multiply-add counts two): the best of a few
/// dispatches that hold every operand in registers. Throws Error(vulkan), Error(device_lost).
double peak(Device& device);

} // namespace cowgpu::engine
