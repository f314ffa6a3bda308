// What the benchmarks do with their command line.
#pragma once

#include "host/cli/command_line.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <optional>

namespace cowgpu::bench {

/// Reads it. The exit code where the program ends here: 0 after help, 2 after words that mean nothing, which are told.
inline std::optional<int> read_command_line(cli::CommandLine& app, int argc, char** argv) {
  const cli::Parsed parsed = app.parse(argc, argv);
  if (!parsed.complaint.empty()) fmt::print(stderr, "{}\n", parsed.complaint);
  if (!parsed.complaint.empty()) return 2;
  return parsed.help ? std::optional(0) : std::nullopt;
}

} // namespace cowgpu::bench
