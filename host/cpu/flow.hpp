// The CPU path of the verb `flow` (host/flow.hpp): each thread takes one point after another from its start to its end.
#pragma once

#include "host/flow.hpp"

#include <memory>
#include <span>

namespace cowgpu::cpu {

/// On `threads` threads (0: all).
std::unique_ptr<DistanceFlow> distance_flow(std::span<const Vec3> vertices, std::span<const Face> faces,
                                            unsigned threads);

} // namespace cowgpu::cpu
