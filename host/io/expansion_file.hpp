// The JSON that `cowgpu expand` writes, read back.
#pragma once

#include "host/io/coefficient_file.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace cowgpu {

/// The expansion `mass` of a file after data/schemas/cowgpu.result.v1.json, as one field of that name with coefficients
/// Q_lm / R^l. Throws Error(cannot_read, too_large, file_syntax, file_format).
CoefficientFile read_expansion(const std::filesystem::path& path);

/// What such coefficients are, in a sentence.
std::string expansion_note(std::string_view reference_radius);

} // namespace cowgpu
