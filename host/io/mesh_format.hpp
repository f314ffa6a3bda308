// The mesh formats that are read: one table, told apart by what a file holds.
#pragma once

#include "host/mesh/raw_mesh.hpp"

#include <span>
#include <string>
#include <string_view>

namespace cowgpu {

struct MeshFormat {
  std::string_view name;     ///< "OFF"
  std::string_view suffixes; ///< lower case, with their dots and a blank between: ".gltf .glb"; empty if it has none
  RawMesh (*parse)(std::string_view bytes, const std::string& name);
};

/// OFF, OBJ, PLY, STL, glTF, PDS plates.
std::span<const MeshFormat> mesh_formats();

/// The format of a file by its first bytes: "ply", "glTF" or a JSON object, the word OFF or one that ends with it, the
/// word solid, a statement of OBJ, the counts and the first vertex of a plate model, the length of a binary STL (which counts
/// more than its text), after comments where the format has them. The suffix of `name` decides only where the bytes say
/// nothing. Throws Error with file_format for something else (what refuse_foreign_file() knows, COLLADA, FBX, STEP, VTK and
/// others by name), file_truncated for an empty file without a known suffix.
const MeshFormat& mesh_format_of(std::string_view bytes, const std::string& name);

/// Reads a mesh of any of the formats. Throws what mesh_format_of() and the format's reader throw. `name` opens every
/// message and becomes RawMesh::name; if its suffix is that of another format, a note says so.
RawMesh parse_mesh(std::string_view bytes, const std::string& name);

} // namespace cowgpu
