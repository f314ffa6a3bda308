// This program run once more, as a process of its own.
#pragma once

#include "host/monitor.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace cowgpu::cli {

/// Runs this program with `arguments` in `folder`; standard output goes to the file `output`, standard error to `errors`
/// (both in `folder`, made anew). `waiting` is called some fifty times a second. A stop that the monitor asks for is passed on, and
/// once the process has ended Error(interrupted) is thrown. Returns the exit code, 128 + n for one that died of signal n.
/// Throws Error(cannot_write) where a file cannot be opened or no process started.
int run_program(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                const std::string& output, const std::string& errors, const Monitor& monitor,
                const std::function<void()>& waiting);

/// In a process that run_program() started: it gets SIGTERM once its parent has died, so that nothing goes on unwatched.
void end_with_parent();

} // namespace cowgpu::cli
