// A picture in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cowgpu {

/// Pixels of four bytes, red, green, blue, alpha: sRGB (IEC 61966-2-1), alpha linear and not multiplied in. Rows from the
/// top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba; ///< 4 width height
  bool opaque = true;             ///< every alpha is 255

  Image() = default;
  Image(int w, int h) : width(w), height(h), rgba(4 * std::size_t(w) * std::size_t(h)) {}
  std::uint8_t* pixel(int x, int y) { return rgba.data() + 4 * (std::size_t(y) * std::size_t(width) + std::size_t(x)); }
  const std::uint8_t* pixel(int x, int y) const {
    return rgba.data() + 4 * (std::size_t(y) * std::size_t(width) + std::size_t(x));
  }
};

} // namespace cowgpu
