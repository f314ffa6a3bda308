// Counts in sentences.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

namespace cowgpu {

/// "1 vertex" or "3 vertices": the number, and the word for one thing or for many.
inline std::string counted(std::uint64_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

} // namespace cowgpu
