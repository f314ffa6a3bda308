// What every reader of files must stand: files cut off, files with bytes changed, files that promise too much.
#pragma once

#include "host/error.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu::test {

/// How `work` ends: a fault and its message, or "none".
struct Outcome {
  std::string fault = "none", message;
  bool says(const std::string& text) const { return message.find(text) != std::string::npos; }
};
Outcome outcome_of(const std::function<void()>& work);

using Reader = std::function<void(std::string_view)>;

/// Gives the reader every prefix of `bytes`, alone in its memory, and asks that it returns or throws an Error.
void check_prefixes(const std::string& bytes, const Reader& read);

/// The same of `rounds` copies with one to four bytes replaced, left out, doubled, or made extreme; the same ones each
/// time.
void check_mutations(const std::string& bytes, int rounds, const Reader& read);

/// `text` with the first `what` replaced; it must be there.
std::string replaced(std::string text, const std::string& what, const std::string& by);

/// By how many bytes the resident memory of a copy of this process grows at most while it does `work`.
std::size_t peak_growth(const std::function<void()>& work);
/// False where a sanitizer makes memory meaningless.
bool memory_is_measurable();

/// The files of tests/corpus/FOLDER, by name.
std::vector<std::filesystem::path> corpus(const std::string& folder);

} // namespace cowgpu::test
