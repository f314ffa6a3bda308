// CPU path of the stage `moments`: all cores, several pairs of triangles per SIMD group.
#pragma once

#include "host/backend.hpp"

namespace cowgpu::cpu {

/// Backend::moments on `threads` threads (0: all). The bits depend on the problem and the instruction set, not on the
/// threads.
Coefficients moments(const MomentProblem& problem, unsigned threads, Monitor& monitor, RunReport* report);

/// Bound of the bytes moments() allocates: 304 a face and 8 a vertex for the plan, P (lmax^2 + 33 lmax) * 8 for the P = 8
/// to 64 partial sums, 16 a coefficient, 640 (lmax + 48) a thread.
std::uint64_t moments_bytes(const MomentProblem& problem, unsigned threads);

} // namespace cowgpu::cpu
