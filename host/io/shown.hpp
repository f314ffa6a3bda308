// Words from files in messages.
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

} // namespace cowgpu
