// Numbers in files.
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace cowgpu {

/// Appends the shortest text, of at most 17 digits, that reads back as the same double.
inline void append_number(std::string& text, double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

} // namespace cowgpu
