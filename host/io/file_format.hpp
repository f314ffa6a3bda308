// The formats of grid and coefficient files, by name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

enum class FileFormat { netcdf, csv };

/// By the suffix, .nc or .csv. Throws Error(bad_argument) for another.
FileFormat file_format(const std::filesystem::path& path);

/// Names of fields as files carry them: those given where all are words (a letter, then letters, digits, '_', '-', '.'),
/// differ, and are not lat or lon; else `word` for one field and word_1, word_2 ... for several.
std::vector<std::string> field_names(const std::vector<std::string>& given, int fields, std::string_view word);

} // namespace cowgpu
