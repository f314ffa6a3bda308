// Words from files, in messages and in other files.
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

/// The text with blanks for line ends and other control characters: for comments in files.
inline std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return text;
}

} // namespace cowgpu
