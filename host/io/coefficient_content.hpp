// The formats of coefficient files, told by what a file holds.
#pragma once

#include "host/io/coefficient_file.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace cowgpu {

/// By the first bytes, whatever the file's name: "HDF" or "CDF" (netCDF); a JSON object with a schema of cowgpu; a line
/// end_of_head or one "gfc l m C S" (ICGEM); a comment as ours ("# lmax", "# normalisation" ...) with a line of names below
/// (CSV); rows of a
/// table of coefficients (looks_like_shtools_text()). Nothing for other files, meshes among them.
std::optional<CoefficientFormat> coefficient_format_in(std::string_view bytes);

/// Whether the bytes say that they are a mesh (OFF, PLY, STL, glTF), rows of whole numbers or not. Never throws.
bool holds_mesh(std::string_view bytes);

/// Whether a file is JSON or CSV, by its content or, where that says nothing, its suffix: of the formats that `cowgpu expand`
/// writes those that can hold several expansions, from which --of chooses. Never throws.
bool can_hold_expansions(const std::filesystem::path& path);

/// The one that a suffix names: .json, .csv, .nc, .gfc, .sh; nothing for another.
std::optional<CoefficientFormat> coefficient_format_named(const std::filesystem::path& path);

/// Whether an input that may be a mesh or a file of coefficients is the latter: by what the file holds; where that says
/// nothing, or there is no such file, by its suffix. Names of built-in bodies and of the catalogue of meshes are none, and what
/// is no regular file (standard input, a pipe) is judged by its name alone. Never throws.
bool is_coefficient_file(const std::string& input);

} // namespace cowgpu
