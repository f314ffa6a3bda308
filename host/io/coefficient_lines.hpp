// Lines of words and numbers, as gravity models and SHTOOLS files have them.
#pragma once

#include "host/coefficient_set.hpp"
#include "host/error.hpp"

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// A text line by line, with messages that name file and line.
class WordLines {
public:
  WordLines(std::string file, std::string_view text) : file_(std::move(file)), rest_(text) {}

  /// The next line, which ends with LF, CRLF or CR, into `line`, its words (between blanks, commas and semicolons) into `words`;
  /// false at the end.
  bool next();
  std::string_view line;
  std::vector<std::string_view> words;
  std::size_t number = 0;    ///< number of the line, from 1
  bool unterminated = false; ///< the line is the file's last one and has no end: it may be a part of one

  /// A finite number, its exponent after E, e, D or d; nothing for another word.
  static std::optional<double> number_in(std::string_view word);
  /// The same. Throws Error(file_syntax).
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

/// A row of a text of coefficients: C and S of a degree and an order, 0 <= m <= l.
struct CoefficientRow {
  int l = 0, m = 0;
  double c = 0, s = 0;
  std::size_t line = 0;
};

/// Coefficients of one real field from rows in any order, into `set`, whose kind is set; its lmax becomes `lmax`. Rows that the
/// file leaves out are 0, C_00 of a potential 1, and notes say so. `complete`: the file has every row, as ours do. `mmax`: where the
/// file says that its orders end below lmax, and no row has a higher one.
///
/// Throws Error(file_syntax) for a row that is there twice, with its line; file_truncated for files that were cut off: rows
/// are missing where they are all asked for, or there is none of degree `lmax`, or none is missing before the last one and it
/// is not the last of `lmax`; too_large where so few rows would make a table of more than 1000 coefficients each. Memory: 40
/// bytes a row, and 16 a coefficient.
void take_rows(std::vector<CoefficientRow>& rows, int lmax, bool complete, WordLines& lines, CoefficientSet& set,
               int mmax = std::numeric_limits<int>::max());

} // namespace cowgpu
