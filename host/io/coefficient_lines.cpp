#include "host/io/coefficient_lines.hpp"
#include "host/number.hpp"

#include "host/io/coefficient_metadata.hpp"
#include "host/io/shown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cowgpu {

bool WordLines::next() {
  if (rest_.empty()) return false;
  const auto end = rest_.find('\n');
  line = rest_.substr(0, end);
  unterminated = end == std::string_view::npos;
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++number;
  words.clear();
  constexpr std::string_view gaps = " \t,";
  for (auto at = line.find_first_not_of(gaps); at != std::string_view::npos;) {
    const auto stop = line.find_first_of(gaps, at);
    words.push_back(line.substr(at, stop - at));
    if (words.size() > 16) break; // no line of these formats has so many
    at = stop == std::string_view::npos ? stop : line.find_first_not_of(gaps, stop);
  }
  return true;
}

double WordLines::real(std::string_view word) const {
  std::string text(word);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == 'D' || c == 'd'; }, 'e');
  const auto value = read_number(text);
  if (!value) fail(Fault::file_syntax, fmt::format("a number expected; '{}' {}", shown(word), not_a_number(text)));
  return *value;
}

int WordLines::whole(std::string_view word, const char* what, int largest) const {
  const auto value = read_whole(word, 0, largest);
  if (!value)
    fail(Fault::file_syntax,
         fmt::format("{} is '{}'; whole numbers from 0 to {} are possible", what, shown(word), largest));
  return *value;
}

void WordLines::judge_end(bool ours, std::vector<std::string>& notes) const {
  if (!unterminated) return;
  if (ours) fail(Fault::file_truncated, "the last line has no end: the file was cut, perhaps within a number");
  notes.push_back("the last line has no end; if the file was cut there, its last number is a part of one");
}

void WordLines::fail(Fault fault, const std::string& sentence) const {
  throw Error(fault, fmt::format("{}: {}", place(file_, number), sentence));
}

} // namespace cowgpu
