// Numbers that people write: values of options, tables, remarks. One rule for all of them.
//
// A number is an optional sign, decimal digits with or without a point, and an optional exponent: 12, -0.5, +.5, 1e-3. A
// whole number is an optional sign and decimal digits; zeros in front change nothing, 010 is ten. The text is the number
// and nothing else: no blank, no comma for the point, no hexadecimal digits, no name such as nan or inf. Nothing depends on
// the locale.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace cowgpu {

/// The number that `text` begins with, rounded correctly; what follows it is left in `text`. Nothing, and `text` as it was,
/// where there is none or it has no place among the finite doubles: above 1.8e308, or below the smallest but not 0.
std::optional<double> take_number(std::string_view& text);

/// The whole of `text` as a finite number, or nothing.
std::optional<double> read_number(std::string_view text);

/// The whole of `text` as a whole number, or nothing; also where it is beyond the ends of std::int64_t.
std::optional<std::int64_t> read_whole(std::string_view text);

/// The whole of `text` as a whole number from 0 to 2^64 - 1, or nothing.
std::optional<std::uint64_t> read_natural(std::string_view text);

/// The whole of `text` as a whole number from `least` to `largest`, or nothing.
template <class Integer>
std::optional<Integer> read_whole(std::string_view text, Integer least, Integer largest) {
  static_assert(sizeof(Integer) < sizeof(std::int64_t) || std::numeric_limits<Integer>::is_signed);
  const auto value = read_whole(text);
  if (!value || *value < std::int64_t(least) || *value > std::int64_t(largest)) return std::nullopt;
  return Integer(*value);
}

/// `N` numbers with single commas between them, or nothing.
template <std::size_t N>
std::optional<std::array<double, N>> read_numbers(std::string_view text) {
  std::array<double, N> numbers{};
  for (std::size_t i = 0; i < N; ++i) {
    const auto value = take_number(text);
    if (!value || (i + 1 < N ? !text.starts_with(',') : !text.empty())) return std::nullopt;
    numbers[i] = *value;
    if (i + 1 < N) text.remove_prefix(1);
  }
  return numbers;
}

/// Why read_number() finds nothing in `text`, to follow the text in a sentence: "is hexadecimal; numbers are decimal".
std::string not_a_number(std::string_view text);

/// The same of read_whole().
std::string not_whole(std::string_view text);

} // namespace cowgpu
