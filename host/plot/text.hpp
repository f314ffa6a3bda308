// Text with sub- and superscripts, cut into runs of one size and slant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cowgpu::plot {

/// Letters that go together.
struct TextRun {
  std::string letters; ///< UTF-8
  bool slanted = false;
  int script = 0; ///< 1 raised, -1 lowered, 0 on the line
};

/// The runs of a text (the markup: canvas.hpp). What is not closed goes to the end.
std::vector<TextRun> text_runs(std::string_view text);

} // namespace cowgpu::plot
