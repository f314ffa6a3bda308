#include "host/io/csv_table.hpp"

#include "host/io/foreign_file.hpp"
#include "host/io/shown.hpp"
#include "host/io/words.hpp"
#include "host/number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace cowgpu {
namespace {

std::string_view without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

// Lines one after the other, without their ends.
class Lines {
public:
  explicit Lines(std::string_view text) : rest_(text) {}
  std::optional<std::string_view> next() {
    if (rest_.empty()) return {};
    const auto end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++number;
    return line;
  }
  std::size_t number = 0;

private:
  std::string_view rest_;
};

void read_row(CsvTable& table, std::string_view line, std::size_t number) {
  std::size_t found = 0;
  for (;; ++found) {
    const auto comma = line.find(',');
    const std::string_view word = without_blanks(line.substr(0, comma));
    const auto value = read_number(word);
    if (!value)
      table.fail(Fault::file_syntax, number,
                 fmt::format("a finite number expected; '{}' {}", shown(word), not_a_number(word)));
    if (found < table.columns.size()) table.values.push_back(*value);
    if (comma == std::string_view::npos) break;
    line.remove_prefix(comma + 1);
  }
  if (++found != table.columns.size())
    table.fail(Fault::file_syntax, number,
               fmt::format("{} numbers expected, as many as line {} has names, found {}", table.columns.size(),
                           table.header_line, found));
}

} // namespace

void CsvTable::fail(Fault fault, std::size_t line, const std::string& sentence) const {
  throw Error(fault, fmt::format("{}:{}: {}", name, line, sentence));
}

void CsvTable::fail_row(std::size_t row, const std::string& sentence) const {
  fail(Fault::file_syntax, first_line + row, sentence);
}

const CsvTable::Attribute& CsvTable::attribute(const std::string& key) const {
  const auto found = attributes.find(key);
  if (found == attributes.end())
    fail(Fault::file_syntax, header_line, fmt::format("above the column names a line '# {} ...' is missing", key));
  return found->second;
}

int CsvTable::integer(const std::string& key, int smallest, int largest) const {
  const Attribute& a = attribute(key);
  const auto value = read_whole(a.text, smallest, largest);
  if (!value)
    fail(Fault::file_syntax, a.line,
         fmt::format("{} is '{}'; from {} to {} are possible", key, shown(a.text), smallest, largest));
  return *value;
}

CsvTable read_csv(const std::filesystem::path& path) {
  return parse_csv(read_input_file(path), path.string());
}

CsvTable parse_csv(std::string_view text, const std::string& name) {
  text = without_byte_order_mark(text);
  CsvTable table;
  table.name = name;
  Lines lines(text);
  std::optional<std::string_view> line;
  while ((line = lines.next()) && (line->starts_with('#') || without_blanks(*line).empty())) {
    const std::string_view comment = without_blanks(without_blanks(*line).substr(line->starts_with('#')));
    const auto space = comment.find_first_of(" \t");
    constexpr std::size_t most_words = 4096; // far more than any file of ours has
    if (space == std::string_view::npos || table.attributes.size() >= most_words) continue;
    table.attributes.try_emplace(std::string(comment.substr(0, space)),
                                 CsvTable::Attribute{std::string(without_blanks(comment.substr(space))), lines.number});
  }
  if (!line) table.fail(Fault::file_truncated, lines.number, "the file ends before the line of column names");
  table.header_line = lines.number;
  for (std::string_view rest = *line;;) {
    const auto comma = rest.find(',');
    const std::string_view word = without_blanks(rest.substr(0, comma));
    if (word.empty() || std::any_of(word.begin(), word.end(), [](char c) { return c < ' ' || c > '~'; }))
      table.fail(Fault::file_format, lines.number,
                 fmt::format("column names between commas expected, found '{}'", shown(*line)));
    table.columns.emplace_back(word);
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  table.first_line = lines.number + 1;
  std::size_t gap = 0;
  while ((line = lines.next())) {
    if (without_blanks(*line).empty()) {
      if (!gap) gap = lines.number;
      continue;
    }
    if (gap) table.fail(Fault::file_syntax, gap, "an empty line among the rows");
    read_row(table, *line, lines.number);
  }
  if (table.attributes.contains("cowgpu") && !text.ends_with('\n'))
    table.fail(Fault::file_truncated, lines.number,
               "the last line has no end: the file was cut, perhaps within a number");
  return table;
}

} // namespace cowgpu
