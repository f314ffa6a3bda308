// Meshes by name: built-in bodies, the catalogue, files.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace cowgpu {

/// Hash of the benchmark mesh, libigl's tutorial cow.off.
inline constexpr const char* benchmark_sha256 = "8834713b505f9bf78c7f7c8b719d51d885d7d059952698da006813d292d84e95";

/// What a word that names a mesh means.
enum class MeshKind {
  builtin,        ///< "builtin:...", host/mesh/builtin.hpp
  catalogue,      ///< a name of host/io/mesh_catalogue.hpp, such as "benchmark", or one that begins with "cgal:"
  standard_input, ///< "-"
  file,           ///< anything else: a path
};

/// The one place where that is decided: by the word alone, whatever files there are. A file whose name is a word of another
/// kind is meant by a path: ./benchmark.
MeshKind mesh_kind(const std::string& word);

/// The file that the word stands for, as far as there is one: a path as it is, or where the catalogue's file was found.
std::optional<std::filesystem::path> mesh_file(const std::string& word);

/// A word for the same mesh in every working folder: paths are made absolute. Throws Error(cannot_read) where the working
/// folder is gone.
std::string mesh_word_anywhere(const std::string& word);

/// The mesh of a word, by its mesh_kind(); a catalogued file's hash is checked, other files are told by their content, of one
/// of mesh_formats(). Files have the word for a name. Throws Error(mesh_missing) with where to get it, cannot_read, and what
/// parse_mesh() and builtin_mesh() throw.
RawMesh load_mesh(const std::string& word);

} // namespace cowgpu
