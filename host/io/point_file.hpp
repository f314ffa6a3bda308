// Points in text files.
#pragma once

#include "host/types.hpp"

#include <filesystem>
#include <vector>

namespace cowgpu {

/// Reads points: one a line, three or more numbers between commas or white space, of which x, y, z are taken; the rest is
/// left aside. A line of names may come first: with one, the columns named x, y and z count, wherever they are; without,
/// the first three. Empty lines and what follows a '#' are skipped. "-" is standard input. Throws Error(cannot_read,
/// too_large), file_syntax with file and line, file_truncated for a file without a point.
std::vector<Vec3> read_points(const std::filesystem::path& path);

} // namespace cowgpu
