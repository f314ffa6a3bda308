// Whole files in.
#pragma once

#include <filesystem>
#include <string>

namespace cowgpu {

/// The bytes of a file, a pipe or a device, to its end ("-" is no special name here). Throws Error with cannot_read (the
/// path and the system's reason: missing, a directory, no permission, a read error, a signal while a pipe was waited
/// for) or too_large (no memory for it, or a pipe or device that has not ended after 1 GiB).
std::string read_file(const std::filesystem::path& path);

} // namespace cowgpu
