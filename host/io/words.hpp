// Text files cut into words and numbers; for files of any origin, held whole in memory.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace cowgpu {

/// `text` without a UTF-8 byte order mark.
std::string_view without_byte_order_mark(std::string_view text);

/// Cuts text into words and counts lines, which end with LF, CRLF, LFCR or CR. A word ends at a blank, a line end or the
/// comment character. A word's line is line() until the next call.
class WordScanner {
public:
  /// `comment` opens a comment that lasts to the line's end; '\0' where the format has none.
  explicit WordScanner(std::string_view text, char comment = '#', std::size_t first_line = 1)
      : begin_(text.data()), at_(text.data()), end_(text.data() + text.size()), comment_(comment), line_(first_line) {}

  std::size_t line() const { return line_; }
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  std::size_t offset() const { return static_cast<std::size_t>(at_ - begin_); }

  /// The next word, on this line or below; empty at the end of the text.
  std::string_view word();

  /// The next word of this line; empty at the line's end.
  std::string_view word_on_line();

  /// The same where a backslash before a line's end, and before blanks there, joins the next line to this one (OBJ); before the end
  /// of the text it joins nothing.
  std::string_view word_on_joined_lines();

  /// To the line's end.
  void skip_line();

  /// To the end of the last of the lines that backslashes join; none in a comment does.
  void skip_joined_lines();

  /// Gives back the last `count` characters of the word just taken.
  void put_back(std::size_t count) { at_ -= count; }

private:
  void skip_blanks();
  void skip_line_end();
  bool at_line_end(const char* at) const;
  std::string_view take();

  const char* begin_;
  const char* at_;
  const char* end_;
  char comment_;
  std::size_t line_;
};

/// The word as a double, rounded correctly; numbers beyond double's range become 0 or infinity, "nan" and "inf" are
/// numbers. Empty if the word is no number.
std::optional<double> to_number(std::string_view word);

/// The word as an integer, held at the ends of the range if beyond it. Empty if the word is no integer.
std::optional<std::int64_t> to_integer(std::string_view word);

/// Whether words of the line are parted by a comma alone in one place and by blanks alone in another: "1,5 2,5". Such a comma may
/// stand for a point.
bool has_mixed_gaps(std::string_view line);

/// Whether the words are the same but for the case of ASCII letters.
bool same_word(std::string_view a, std::string_view b);

} // namespace cowgpu
