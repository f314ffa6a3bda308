// Points in an order in which neighbours are near each other.
#pragma once

#include "host/types.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace cowgpu {

/// The order of points along a Morton curve of 2^10 cells a side through [low, high]; points outside count as on its sides.
/// Points of one cell keep their order. On `threads` threads (0: all).
std::vector<std::uint32_t> morton_order(std::span<const Vec3> points, const Vec3& low, const Vec3& high,
                                        unsigned threads);

} // namespace cowgpu
