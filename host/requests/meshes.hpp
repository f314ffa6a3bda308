// The meshes that have names: which there are, and which are on this machine.
#pragma once

#include "host/io/mesh_catalogue.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cowgpu {

/// A body of the catalogue, and the path of its file where that is on this machine.
struct NamedMesh {
  CatalogueEntry entry;
  std::optional<std::filesystem::path> path;
};

/// The catalogue, in its order. Reads the files, to know them by their hashes.
std::vector<NamedMesh> named_meshes();

/// How built-in bodies are written, in the order to list them: "builtin:sphere[:R][@LEVEL]".
std::vector<std::string> builtin_usages();

/// The names of the formats of mesh files that are read: "OFF", "OBJ" ...
std::vector<std::string> mesh_format_names();

} // namespace cowgpu
