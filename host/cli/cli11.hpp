// CLI11, with numbers by the rule of host/number.hpp in every option. By itself it takes 010 for eight, 0x10 for sixteen and
// " 8" for eight. Include this, not <CLI/CLI.hpp>: all conversions of a program are the same functions. It takes ten seconds
// to compile in each file, so that options are added by way of host/cli/command_line.hpp, which does not show it.
#pragma once

#include "host/number.hpp"

#include <string>

#ifdef CLI11_VERSION
#error "include host/cli/cli11.hpp before CLI11"
#endif

// CLI11 prefers this to its own template for doubles, as it is declared before.
namespace CLI::detail {
inline bool lexical_cast(const std::string& input, double& output) {
  const auto read = cowgpu::read_number(input);
  if (read) output = *read;
  return read.has_value();
}
} // namespace CLI::detail

#include <CLI/CLI.hpp>

#include <limits>
#include <type_traits>

namespace cowgpu::cli {

template <class Integer>
bool to_integer(std::string_view text, Integer& value) noexcept {
  if constexpr (std::is_signed_v<Integer>) {
    const auto read = read_whole(text);
    if (!read || *read < std::numeric_limits<Integer>::min() || *read > std::numeric_limits<Integer>::max())
      return false;
    value = Integer(*read);
  } else {
    const auto read = read_natural(text);
    if (!read || *read > std::numeric_limits<Integer>::max()) return false;
    value = Integer(*read);
  }
  return true;
}

} // namespace cowgpu::cli

// The conversions to which CLI11 sends every integer.
namespace CLI::detail {

template <>
inline bool integral_conversion<int>(const std::string& input, int& output) noexcept {
  return cowgpu::cli::to_integer(input, output);
}
template <>
inline bool integral_conversion<long>(const std::string& input, long& output) noexcept {
  return cowgpu::cli::to_integer(input, output);
}
template <>
inline bool integral_conversion<long long>(const std::string& input, long long& output) noexcept {
  return cowgpu::cli::to_integer(input, output);
}
template <>
inline bool integral_conversion<unsigned>(const std::string& input, unsigned& output) noexcept {
  return cowgpu::cli::to_integer(input, output);
}
template <>
inline bool integral_conversion<unsigned long>(const std::string& input, unsigned long& output) noexcept {
  return cowgpu::cli::to_integer(input, output);
}
template <>
inline bool integral_conversion<unsigned long long>(const std::string& input, unsigned long long& output) noexcept {
  return cowgpu::cli::to_integer(input, output);
}
} // namespace CLI::detail
