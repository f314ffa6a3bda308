#include "host/io/shown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace cowgpu {
namespace {

struct Character {
  std::uint32_t code = 0;
  std::size_t length = 1; // bytes
  bool valid = false;
};

// The character that begins at `at`; one invalid byte where none does (Unicode 15, table 3-7).
Character character_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return std::uint32_t(static_cast<unsigned char>(text[i])); };
  const std::uint32_t first = byte(at);
  if (first < 0x80) return {first, 1, true};
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || at + length > text.size()) return {};
  std::uint32_t code = first & (0x7fU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(at + i) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(at + i) & 0x3f);
  }
  constexpr std::uint32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < smallest[length] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
  return {code, length, true};
}

bool is_control(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

// Line and paragraph separators, and what turns the direction of writing: text behind them is shown where it does not stand.
bool is_mark(std::uint32_t code) {
  return code == 0x200e || code == 0x200f || code == 0x061c || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069) || code == 0xfeff;
}

bool is_plain(std::string_view text, bool lines) {
  return std::all_of(text.begin(), text.end(),
                     [&](char c) { return (c >= ' ' && c <= '~') || (lines && (c == '\n' || c == '\t')); });
}

std::string safe(std::string_view text, bool lines) {
  if (is_plain(text, lines)) return std::string(text);
  std::string result;
  result.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Character c = character_at(text, at);
    if (!c.valid || is_mark(c.code))
      result += '?';
    else if (is_control(c.code) && !(lines && (c.code == '\n' || c.code == '\t')))
      result += ' ';
    else
      result += text.substr(at, c.length);
    at += c.length;
  }
  return result;
}

} // namespace

std::string one_line(std::string_view text) {
  return safe(text, false);
}

std::string terminal_text(std::string_view text) {
  return safe(text, true);
}

std::string terminal_json(std::string json) {
  if (is_plain(json, true)) return json;
  std::string result;
  result.reserve(json.size());
  for (std::size_t at = 0; at < json.size();) {
    const Character c = character_at(json, at);
    if (c.valid && ((c.code >= 0x7f && is_control(c.code)) || is_mark(c.code)))
      result += fmt::format("\\u{:04x}", c.code);
    else
      result += json.substr(at, c.length);
    at += c.length;
  }
  return result;
}

} // namespace cowgpu
