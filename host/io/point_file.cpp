#include "host/io/point_file.hpp"

#include "host/error.hpp"
#include "host/io/foreign_file.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace cowgpu {
namespace {

// Commas stand alone, white space in any number. An empty word lies between two commas.
std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  constexpr std::string_view space = " \t\r\f\v";
  line = line.substr(0, line.find('#'));
  for (;;) {
    const auto first = line.find_first_not_of(space);
    if (first == std::string_view::npos) return words;
    line.remove_prefix(first);
    const auto end = std::min(line.find_first_of(" \t\r\f\v,"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
    line.remove_prefix(std::min(line.find_first_not_of(space), line.size()));
    if (!line.starts_with(',')) continue;
    line.remove_prefix(1);
    if (line.find_first_not_of(space) == std::string_view::npos) words.emplace_back(); // nothing after the last comma
  }
}

} // namespace

std::vector<Vec3> read_points(const std::filesystem::path& path) {
  const std::string bytes = read_input_file(path == "-" ? "/dev/stdin" : path);
  const std::string name = path == "-" ? "standard input" : path.string();
  std::string_view text = bytes;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  std::vector<Vec3> points;
  std::array<std::size_t, 3> columns{0, 1, 2};
  bool first = true;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const auto fail = [&](const std::string& sentence) {
      throw Error(Fault::file_syntax, fmt::format("{}:{}: {}", name, number, sentence));
    };
    const auto end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, std::min(end, text.find('#')));
    const auto words = words_of(line);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (words.empty()) continue;
    if (std::exchange(first, false) && std::none_of(words.begin(), words.end(), read_number)) {
      for (std::size_t c = 0; c < 3; ++c) {
        const auto found = std::find(words.begin(), words.end(), std::string_view("xyz").substr(c, 1));
        if (found == words.end()) fail(fmt::format("a line of names without one that is {}", "xyz"[c]));
        columns[c] = std::size_t(found - words.begin());
      }
      continue;
    }
    if (has_mixed_gaps(line))
      fail(fmt::format("blanks and commas both part the numbers of '{}'; if a comma stands for the point in one of "
                       "them, write a point",
                       shown(line, 60)));
    Vec3 point;
    for (std::size_t c = 0; c < 3; ++c) {
      if (columns[c] >= words.size())
        fail(fmt::format("x, y and z expected, found {} number{}", words.size(), words.size() == 1 ? "" : "s"));
      const std::string_view word = words[columns[c]];
      const auto value = read_number(word);
      if (!value) fail(fmt::format("a finite number expected; '{}' {}", shown(word), not_a_number(word)));
      point[Eigen::Index(c)] = *value;
    }
    points.push_back(point);
  }
  if (points.empty())
    throw Error(Fault::file_truncated, fmt::format("{}: there is no point; one a line is expected: x,y,z", name));
  return points;
}

} // namespace cowgpu
