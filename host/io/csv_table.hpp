// Tables of numbers in text: comments with attributes, a line of column names, rows.
#pragma once

#include "host/error.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// A table as read. Lines are counted from 1.
struct CsvTable {
  struct Attribute {
    std::string text;
    std::size_t line = 0;
  };

  std::string name;                            ///< name of the file
  std::map<std::string, Attribute> attributes; ///< values of lines "# key value"; the first of several counts
  std::vector<std::string> columns;
  std::vector<double> values; ///< row after row
  std::size_t header_line = 0;
  std::size_t first_line = 0; ///< line of the first row; the rows have no gaps

  std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
  double at(std::size_t row, std::size_t column) const { return values[row * columns.size() + column]; }

  /// Throws Error(fault, "NAME:LINE: sentence").
  [[noreturn]] void fail(Fault fault, std::size_t line, const std::string& sentence) const;
  [[noreturn]] void fail_row(std::size_t row, const std::string& sentence) const; ///< file_syntax

  /// An attribute's text; throws Error(file_syntax) where it is missing.
  const Attribute& attribute(const std::string& key) const;
  /// A whole number in a range; throws Error(file_syntax).
  int integer(const std::string& key, int smallest, int largest) const;
};

/// Reads a table: an optional byte order mark; lines ended by LF or CRLF; lines that open with '#' before the column
/// names, which are words between commas; then rows of as many finite numbers, without gaps or comments. Throws
/// Error(cannot_read, too_large, file_syntax, file_truncated).
CsvTable read_csv(const std::filesystem::path& path);

/// The same of a text; `name` opens every message.
CsvTable parse_csv(std::string_view text, const std::string& name);

} // namespace cowgpu
