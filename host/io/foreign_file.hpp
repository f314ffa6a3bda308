// Files that are something else than any input of the program, told by name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace cowgpu {

/// Throws Error(file_format), which says what the bytes are and what to do, for what stands in a file's place, whatever was
/// expected: pointers of Git LFS and git-annex, archives and compressed files (3MF among them), web pages, PDF, text in
/// UTF-16. Told by the first bytes; `name` opens the message. All else passes.
void refuse_foreign_file(std::string_view bytes, const std::string& name);

/// read_file(), and then refuse_foreign_file(): for what a user gives as input.
std::string read_input_file(const std::filesystem::path& path);

} // namespace cowgpu
