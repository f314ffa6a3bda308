// Meshes by name: built-in bodies, the catalogue, files.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <string>

namespace cowgpu {

/// Hash of the benchmark mesh, libigl's tutorial cow.off.
inline constexpr const char* benchmark_sha256 = "8834713b505f9bf78c7f7c8b719d51d885d7d059952698da006813d292d84e95";

/// A mesh by name: "builtin:..." (host/mesh/builtin.hpp), a name of the catalogue such as "benchmark" or "cgal:bull"
/// (host/io/mesh_catalogue.hpp; the file's hash is checked), "-" for standard input, anything else a path to a file of one of mesh_formats(), told by its content. Throws
/// Error(mesh_missing) with where to get it, cannot_read, and what parse_mesh() and builtin_mesh() throw.
RawMesh load_mesh(const std::string& name);

} // namespace cowgpu
