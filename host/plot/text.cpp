#include "host/plot/text.hpp"

namespace cowgpu::plot {
namespace {

std::size_t letter_length(char first) {
  const auto c = static_cast<unsigned char>(first);
  return c < 0x80 ? 1 : c < 0xe0 ? 2 : c < 0xf0 ? 3 : 4;
}

/// Latin letters and small Greek ones.
bool slants(std::string_view letter) {
  if (letter.size() == 1) return (letter[0] >= 'a' && letter[0] <= 'z') || (letter[0] >= 'A' && letter[0] <= 'Z');
  return letter >= "α" && letter <= "ω" && letter.size() == 2;
}

} // namespace

std::vector<TextRun> text_runs(std::string_view text) {
  std::vector<TextRun> runs;
  bool mathematics = false, group = false; // inside braces of a script
  int script = 0;
  const auto put = [&](std::string_view letter) {
    const bool slanted = mathematics && slants(letter);
    if (runs.empty() || runs.back().slanted != slanted || runs.back().script != script)
      runs.push_back({"", slanted, script});
    runs.back().letters += letter;
    if (!group) script = 0;
  };
  for (std::size_t i = 0; i < text.size();) {
    const std::string_view letter = text.substr(i, letter_length(text[i]));
    i += letter.size();
    if (letter == "$") {
      if (i < text.size() && text[i] == '$') {
        put("$");
        ++i;
      } else {
        mathematics = !mathematics;
        script = 0;
        group = false;
      }
    } else if (mathematics && !group && (letter == "_" || letter == "^")) {
      script = letter == "_" ? -1 : 1;
      if (i < text.size() && text[i] == '{') {
        group = true;
        ++i;
      }
    } else if (group && letter == "}") {
      group = false;
      script = 0;
    } else
      put(letter);
  }
  return runs;
}

} // namespace cowgpu::plot
