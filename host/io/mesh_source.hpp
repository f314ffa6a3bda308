// Meshes by name: built-in bodies, the benchmark, files.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace cowgpu {

/// Hash of the benchmark mesh, libigl's tutorial cow.off.
inline constexpr const char* benchmark_sha256 = "8834713b505f9bf78c7f7c8b719d51d885d7d059952698da006813d292d84e95";

/// Where named meshes are looked for, in order: $COWGPU_MESHES, the installed data folder, data/meshes of the sources.
std::vector<std::filesystem::path> mesh_folders();

/// A mesh by name: "builtin:..." (host/mesh/builtin.hpp), "benchmark" (cow.off in one of mesh_folders(), its hash
/// checked), "-" for standard input, anything else a path to a file of one of mesh_formats(), told by its content. Throws
/// Error(mesh_missing) with where to get the benchmark, cannot_read, and what parse_mesh() and builtin_mesh() throw.
RawMesh load_mesh(const std::string& name);

} // namespace cowgpu
