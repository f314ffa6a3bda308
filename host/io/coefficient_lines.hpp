// Lines of words and numbers, as gravity models and SHTOOLS files have them.
#pragma once

#include "host/error.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// A text line by line, with messages that name file and line.
class WordLines {
public:
  WordLines(std::string file, std::string_view text) : file_(std::move(file)), rest_(text) {}

  /// The next line into `line`, its words (between blanks and commas) into `words`; false at the end.
  bool next();
  std::string_view line;
  std::vector<std::string_view> words;
  std::size_t number = 0;    ///< of the line, from 1
  bool unterminated = false; ///< the line is the file's last one and has no end: it may be a part of one

  /// A finite number, its exponent after E, e, D or d. Throws Error(file_syntax).
  double real(std::string_view word) const;
  /// A whole number from 0 to `largest`. Throws Error(file_syntax).
  int whole(std::string_view word, const char* what, int largest) const;
  /// Of the last line, if it has no end: a file of ours (`ours`) was cut there; of another one a note says so. Throws
  /// Error(file_truncated).
  void judge_end(bool ours, std::vector<std::string>& notes) const;
  [[noreturn]] void fail(Fault fault, const std::string& sentence) const;
  const std::string& file() const { return file_; }

private:
  std::string file_;
  std::string_view rest_;
};

} // namespace cowgpu
