// The options that mend a mesh before anything is made of it.
#pragma once

#include "host/mesh/mend.hpp"

#include "host/cli/command_line.hpp"

#include <string>

namespace cowgpu::cli {

/// Adds --weld, --orient and --largest-shell.
void add_mend_options(Command& command, Mending& mending);

/// Reads a mesh and mends it; what was done is in its notes. Throws what load_mesh() and mend() throw, Error(interrupted).
RawMesh load_mended(const std::string& name, const Mending& mending);

} // namespace cowgpu::cli
