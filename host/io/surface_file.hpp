// Surface expansions in the JSON that `cowgpu expand` writes, read back.
#pragma once

#include "host/mesh/placement.hpp"
#include "host/spectrum/reconstruct.hpp"

#include <filesystem>
#include <string>

namespace cowgpu {

/// One surface expansion of a result file.
struct SurfaceFile {
  std::string name;            ///< its key: "stretch"
  SurfaceExpansion expansion;  ///< the doubles that were written
  std::string recipe;          ///< "default" or "paper"
  std::string map_method;      ///< "stretch", "file" ...
  std::string mesh, mesh_hash; ///< name and SHA-256 of the mesh that was expanded
  Placement placement;         ///< placement of that mesh
};

/// Whether a name is that of a result file rather than of a mesh: it ends in .json.
bool is_result_file(const std::filesystem::path& path);

/// Reads `expansions.<of>` of a file after data/schemas/cowgpu.result.v1.json; of "": stretch where there is one, else the
/// only surface expansion. Memory: about ten times the file. Throws Error(cannot_read, too_large), file_syntax,
/// file_format for another document, missing members, coefficients that do not fit each other or no surface expansion at
/// all, and bad_argument where `of` is missing from the file or several expansions leave the choice open; the message
/// names those that are there.
SurfaceFile read_surface(const std::filesystem::path& path, const std::string& of = "");

} // namespace cowgpu
