// Which signal told the program to stop, once catch_signals() (host/cli/console.hpp) has caught one.
#pragma once

#include <string>

namespace cowgpu::cli {

/// The exit code once a stop is requested: 128 + the signal's number, as shells have it (130 for SIGINT).
int stop_exit_code();

/// The signal in brackets, where that is not plain: " (Hangup)".
std::string stop_reason();

} // namespace cowgpu::cli
