// What this processor can do at most.
#pragma once

namespace cowgpu::cpu {

/// Measured double-precision multiply-add throughput of `threads` threads in flops per second (a multiply-add counts
/// two), with the instruction set the kernels use and every operand in registers. Takes about 50 ms.
double peak(unsigned threads);

} // namespace cowgpu::cpu
