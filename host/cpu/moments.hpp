// CPU path of the stage `moments`: all cores, several pairs of triangles per SIMD group.
#pragma once

#include "host/moment_problem.hpp"
#include "host/monitor.hpp"
#include "host/multipoles.hpp"
#include "host/run_report.hpp"

namespace cowgpu::cpu {

/// Backend::moments on `threads` threads (0: all). The bits depend on the problem and the instruction set, not on the
/// threads.
Multipoles moments(const MomentProblem& problem, unsigned threads, Monitor& monitor, RunReport* report);

/// Bound of the bytes moments() allocates, its result included: 304 a face and 8 a vertex for the plan, 32 a coefficient,
/// 640 (lmax + 48) a thread, and partial sums of 8 (lmax^2 + 33 lmax) each: one a thread, or up to 64 MiB of them.
std::uint64_t moments_bytes(const MomentProblem& problem, unsigned threads);

} // namespace cowgpu::cpu
