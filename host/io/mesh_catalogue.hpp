// Named bodies: data/meshes/catalogue.json, which the program carries with it, and where their files are.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cowgpu {

/// A body of the catalogue. The mesh itself is in a file of that SHA-256, or is missing on this machine.
struct CatalogueEntry {
  std::string name;   ///< "cgal:bull", as MESH takes it
  std::string file;   ///< below one of mesh_folders(): "cgal/bull.off"
  std::string sha256; ///< hash of the file
  std::size_t vertices = 0, triangles = 0;
  std::string what, source, licence, scale, axes; ///< for people
};

/// The bodies of the catalogue, in its order.
const std::vector<CatalogueEntry>& mesh_catalogue();

/// The entry of a name, or null.
const CatalogueEntry* catalogue_entry(std::string_view name);

/// Where meshes are looked for, in order: $COWGPU_MESHES, the user's folder ($XDG_DATA_HOME/cowgpu/meshes, else
/// ~/.local/share/cowgpu/meshes), the installed data folder, data/meshes of the sources.
std::vector<std::filesystem::path> mesh_folders();

/// The folder that add_mesh() copies to: $COWGPU_MESHES if set, else the user's. Throws Error(bad_argument) where there is
/// neither.
std::filesystem::path own_mesh_folder();

/// The bytes of the entry's file, from the first folder that has it with the right SHA-256. Throws Error(mesh_missing) with
/// the source, the hash and the folders, naming files of another hash that stand in its place; cannot_read.
std::string read_catalogued(const CatalogueEntry& entry);

/// Whether a file of the right hash is in one of the folders; its path.
std::optional<std::filesystem::path> find_catalogued(const CatalogueEntry& entry);

/// Copies the file to own_mesh_folder() under the name of the entry whose SHA-256 it has, and returns the entry. Throws
/// Error(file_format) where the catalogue has no such file; cannot_read, cannot_write.
const CatalogueEntry& add_mesh(const std::filesystem::path& file);

} // namespace cowgpu
