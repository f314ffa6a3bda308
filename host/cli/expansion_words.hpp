// The words of --of, --recipe, --time and --fields, for every command that has them.
#pragma once

#include "host/requests/expand_surfaces.hpp"

#include <string>

namespace cowgpu::cli {

/// Reads the list `of` (commas; "all") and `recipe` ("default", "paper"). Throws Error(bad_argument) for a name that is
/// none, for the paper's recipe without the harmonic map or the flow, and for a map file without just one map that it stands for.
ExpansionChoice parse_expansions(const std::string& of, const std::string& recipe, const std::string& map_file,
                                 int lmax);

/// Reads --time: "auto" (0), or a finite number above 0. Throws Error(bad_argument).
double parse_flow_time(const std::string& text);

/// Reads --fields: "xyz" or "f". Throws Error(bad_argument).
SurfaceFields parse_fields(const std::string& text);

} // namespace cowgpu::cli
