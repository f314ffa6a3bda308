#include "host/number.hpp"

#include <algorithm>

namespace cowgpu {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_sign(char c) {
  return c == '+' || c == '-';
}

bool is_blank(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

// How many characters of `text` are a number by the rule; 0: it begins with none.
std::size_t length_of_number(std::string_view text) {
  std::size_t at = !text.empty() && is_sign(text[0]) ? 1 : 0, digits = 0;
  for (; at < text.size() && is_digit(text[at]); ++at) ++digits;
  if (at < text.size() && text[at] == '.') {
    std::size_t after = at + 1;
    for (; after < text.size() && is_digit(text[after]); ++after) ++digits;
    if (digits) at = after;
  }
  if (!digits) return 0;
  if (at == text.size() || (text[at] != 'e' && text[at] != 'E')) return at;
  std::size_t exponent = at + 1;
  if (exponent < text.size() && is_sign(text[exponent])) ++exponent;
  const std::size_t first = exponent;
  while (exponent < text.size() && is_digit(text[exponent])) ++exponent;
  return exponent > first ? exponent : at;
}

// from_chars knows no plus sign.
std::string_view without_plus(std::string_view text) {
  return text.substr(text.starts_with('+'));
}

bool is_whole(std::string_view text) {
  const std::string_view digits = text.substr(!text.empty() && is_sign(text[0]));
  return !digits.empty() && std::all_of(digits.begin(), digits.end(), is_digit);
}

template <class Number>
std::optional<Number> converted(std::string_view text) {
  text = without_plus(text);
  Number value{};
  if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc()) return std::nullopt;
  return value;
}

bool is_named(std::string_view text) {
  std::string word;
  for (const char c : text.substr(!text.empty() && is_sign(text[0])))
    word += c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  return word.starts_with("nan") || word == "inf" || word == "infinity";
}

bool is_hexadecimal(std::string_view text) {
  text = text.substr(!text.empty() && is_sign(text[0]));
  return text.starts_with("0x") || text.starts_with("0X");
}

} // namespace

std::optional<double> take_number(std::string_view& text) {
  const std::size_t length = length_of_number(text);
  if (!length) return std::nullopt;
  const auto value = converted<double>(text.substr(0, length));
  if (value) text.remove_prefix(length);
  return value;
}

std::optional<double> read_number(std::string_view text) {
  const auto value = take_number(text);
  return text.empty() ? value : std::nullopt;
}

std::optional<std::int64_t> read_whole(std::string_view text) {
  return is_whole(text) ? converted<std::int64_t>(text) : std::nullopt;
}

std::optional<std::uint64_t> read_natural(std::string_view text) {
  const bool minus = text.starts_with('-');
  if (!is_whole(text)) return std::nullopt;
  const auto value = converted<std::uint64_t>(text.substr(minus));
  return minus && value != std::uint64_t(0) ? std::nullopt : value;
}

std::string not_a_number(std::string_view text) {
  if (text.empty()) return "is empty";
  const std::size_t length = length_of_number(text);
  if (length && !converted<double>(text.substr(0, length))) return "is beyond the range of doubles";
  if (is_named(text)) return "is not finite";
  if (is_hexadecimal(text)) return "is hexadecimal; numbers are decimal";
  if (const std::size_t comma = text.find(','); comma != std::string_view::npos) {
    std::string point(text);
    point[comma] = '.';
    if (const std::size_t all = length_of_number(point); all > comma)
      return "has a comma where numbers have a point: " + point.substr(0, all);
  }
  if (std::any_of(text.begin(), text.end(), is_blank)) return "has a blank in it";
  return "is not a number";
}

std::string not_whole(std::string_view text) {
  if (is_whole(text)) return text.front() == '-' ? "is too small" : "is too large";
  if (length_of_number(text) == text.size() && !text.empty())
    return "is not written as a whole number, in digits alone";
  return not_a_number(text);
}

} // namespace cowgpu
