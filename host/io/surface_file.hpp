// Surface expansions in files, read back.
#pragma once

#include "host/mesh/placement.hpp"
#include "host/spectrum/reconstruct.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace cowgpu {

/// One surface expansion of a file.
struct SurfaceFile {
  std::string name;                    ///< its key: "stretch"
  SurfaceExpansion expansion;          ///< the doubles that were written
  std::string recipe;                  ///< "default" or "paper"
  std::string map_method;              ///< "stretch", "file" ...
  std::string mesh, mesh_hash;         ///< name and SHA-256 of the mesh that was expanded
  Placement placement;                 ///< placement of that mesh; the units of the expansion
  std::vector<std::string> notes = {}; ///< sentences of the reader
};

/// Whether a name is that of a result file rather than of a mesh: it ends in .json.
bool is_result_file(const std::filesystem::path& path);

/// Reads `expansions.<of>` of a file after data/schemas/cowgpu.result.v1.json; of "": stretch where there is one, else the
/// only surface expansion. Memory: about ten times the file. Throws Error(cannot_read, too_large), file_syntax,
/// file_format for another document, missing members, coefficients that do not fit each other or no surface expansion at
/// all, and bad_argument where `of` is missing from the file or several expansions leave the choice open; the message
/// names those that are there.
SurfaceFile read_surface(const std::filesystem::path& path, const std::string& of = "");

/// Whether a file is JSON that holds expansions, which read_surface() reads. Throws what parsing throws.
bool holds_expansions(const std::filesystem::path& path);

/// A surface in any other coefficient file (host/io/coefficient_file.hpp) with the fields f_r, f_dtheta, f_dphi, x, y, z: what
/// `cowgpu convert` wrote, and the CSV of `cowgpu expand`, whose columns are named after their expansion; `of` as
/// read_surface() has it. Recipe, map and placement are not known, but whether lengths are in metres. Throws what
/// read_coefficient_set() throws, Error(file_format) for other coefficients.
SurfaceFile read_surface_fields(const std::filesystem::path& path, const std::string& of = "");

} // namespace cowgpu
