// The options that mend a mesh before anything is made of it.
#pragma once

#include "host/cli/command_line.hpp"
#include "host/requests/load_body.hpp"

namespace cowgpu::cli {

/// Adds --weld, --orient and --largest-shell.
void add_mend_options(Command& command, Mending& mending);

} // namespace cowgpu::cli
