// Sobol's sequence in two dimensions.
#pragma once

#include <cstdint>

namespace cowgpu::plan {

struct SobolPoint {
  double x, y; ///< in (0, 1)
};

/// Any 16 points that start at a multiple of 16 fall into all 16 strips of either direction and all boxes of 4 x 4.
inline SobolPoint sobol(std::uint32_t i) {
  std::uint32_t x = 0, y = 0;
  for (std::uint32_t bit = 0x80000000U, v = 0x80000000U; i; i >>= 1, bit >>= 1, v ^= v >> 1)
    if (i & 1) x ^= bit, y ^= v;
  return {(x + 0.5) * 0x1p-32, (y + 0.5) * 0x1p-32};
}

} // namespace cowgpu::plan
