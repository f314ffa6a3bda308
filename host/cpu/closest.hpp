// The CPU path of the verb `closest` (host/distance_field.hpp).
#pragma once

#include "host/distance_field.hpp"

#include <memory>
#include <span>

namespace cowgpu::cpu {

/// On `threads` threads (0: all).
std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices, std::span<const Face> faces,
                                              unsigned threads);

} // namespace cowgpu::cpu
