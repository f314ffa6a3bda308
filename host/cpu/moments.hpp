// CPU path of the stage `moments`: all cores, several pairs of triangles per SIMD group.
#pragma once

#include "host/moments.hpp"

#include <memory>

namespace cowgpu::cpu {

/// Backend::moments on `threads` threads (0: all). The bits depend on the problem and the instruction set, not on the
/// threads.
std::unique_ptr<PreparedMoments> moments(const MomentProblem& problem, unsigned threads);

} // namespace cowgpu::cpu
