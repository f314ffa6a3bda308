#include "host/io/words.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace cowgpu {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}
char lower(char c) {
  return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
}

/// from_chars knows no plus sign.
std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  return word;
}

template <class Number>
std::from_chars_result read(std::string_view word, Number& value) {
  return std::from_chars(word.data(), word.data() + word.size(), value);
}

} // namespace

std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

std::string_view WordScanner::word() {
  skip_blanks();
  while (at_ != end_ && is_line_end(*at_)) {
    skip_line_end();
    skip_blanks();
  }
  return take();
}

std::string_view WordScanner::word_on_line() {
  skip_blanks();
  return take();
}

std::string_view WordScanner::word_on_joined_lines() {
  for (;;) {
    skip_blanks();
    if (at_ == end_ || *at_ != '\\' || !at_line_end(at_ + 1)) break;
    skip_line();
    if (at_ == end_) break;
    skip_line_end();
  }
  std::string_view word = take();
  if (word.ends_with('\\') && at_line_end(at_)) {
    word.remove_suffix(1);
    at_ = word.data() + word.size(); // the next call finds the backslash
  }
  return word;
}

void WordScanner::skip_joined_lines() {
  for (;;) {
    const char* begin = at_;
    skip_line();
    std::string_view line(begin, static_cast<std::size_t>(at_ - begin));
    while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
    if (at_ == end_ || !line.ends_with('\\') || (comment_ != '\0' && line.find(comment_) != std::string_view::npos))
      return;
    skip_line_end();
  }
}

bool WordScanner::at_line_end(const char* at) const {
  while (at != end_ && is_blank(*at)) ++at;
  return at == end_ || is_line_end(*at);
}

void WordScanner::skip_line() {
  while (at_ != end_ && !is_line_end(*at_)) ++at_;
}

void WordScanner::skip_blanks() {
  while (at_ != end_ && is_blank(*at_)) ++at_;
  if (at_ != end_ && comment_ != '\0' && *at_ == comment_) skip_line();
}

void WordScanner::skip_line_end() {
  if (at_ + 1 != end_ && is_line_end(at_[1]) && at_[1] != *at_) ++at_;
  ++at_;
  ++line_;
}

std::string_view WordScanner::take() {
  const char* begin = at_;
  while (at_ != end_ && !is_blank(*at_) && !is_line_end(*at_) && (comment_ == '\0' || *at_ != comment_)) ++at_;
  return {begin, static_cast<std::size_t>(at_ - begin)};
}

std::optional<double> to_number(std::string_view word) {
  word = without_plus(word);
  double value = 0;
  auto result = read(word, value);
  if (result.ec == std::errc::result_out_of_range) {
    long double wide = 0;
    result = read(word, wide);
    if (std::fabs(wide) > std::numeric_limits<double>::max()) wide = std::copysign(HUGE_VALL, wide);
    value = static_cast<double>(wide);
  }
  if (result.ec != std::errc() || result.ptr != word.data() + word.size()) return {};
  return value;
}

std::optional<std::int64_t> to_integer(std::string_view word) {
  word = without_plus(word);
  std::int64_t value = 0;
  const auto result = read(word, value);
  if (result.ptr != word.data() + word.size()) return {};
  if (result.ec == std::errc::result_out_of_range)
    return word[0] == '-' ? std::numeric_limits<std::int64_t>::min() : std::numeric_limits<std::int64_t>::max();
  if (result.ec != std::errc()) return {};
  return value;
}

bool has_mixed_gaps(std::string_view line) {
  constexpr std::string_view gaps = " \t\v\f\r,";
  bool blanks = false, commas = false;
  for (auto stop = line.find_first_of(gaps, line.find_first_not_of(gaps)); stop < line.size();) {
    const auto next = line.find_first_not_of(gaps, stop);
    if (next == std::string_view::npos) break;
    const std::string_view gap = line.substr(stop, next - stop);
    commas = commas || gap == ",";
    blanks = blanks || gap.find(',') == std::string_view::npos;
    stop = line.find_first_of(gaps, next);
  }
  return blanks && commas;
}

bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

} // namespace cowgpu
