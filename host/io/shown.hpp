// Words and texts of files and command lines, safe to show: in messages, on a terminal, in comments of other files.
#pragma once

#include <string>
#include <string_view>

namespace cowgpu {

/// The first characters of a word, with '?' for what is not plain ASCII.
inline std::string shown(std::string_view word, std::size_t most = 24) {
  std::string text(word.substr(0, most));
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return word.size() > text.size() ? text + "..." : text;
}

/// The text as one line of UTF-8 without anything a terminal obeys: blanks for line ends and control characters (C0, DEL,
/// C1), '?' for bytes that are no UTF-8 and for the marks that break lines or turn the direction of writing. For names
/// and remarks of files, and for comments in files.
std::string one_line(std::string_view text);

/// Text of several lines for a terminal: what one_line() makes of it, but line feeds and tabs stay.
std::string terminal_text(std::string_view text);

/// JSON whose texts hold no such character unescaped: DEL, C1 and the marks become \uXXXX, which reads back the same.
/// `json` must be valid UTF-8, its C0 characters escaped already.
std::string terminal_json(std::string json);

} // namespace cowgpu
