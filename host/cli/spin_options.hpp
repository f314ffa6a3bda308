// The options of commands about spinning bodies: how heavy they are, how fast they turn, and about what.
#pragma once

#include "host/cli/command_line.hpp"
#include "host/types.hpp"
#include "host/units.hpp"

#include <optional>
#include <string>
#include <vector>

namespace cowgpu::cli {

struct SpinOptions {
  std::string mass, period, omega, axis;
};

/// Adds --mass, --period, --omega and --spin; `through` names the point that the axis runs through.
void add_spin_options(Command& command, SpinOptions& options, const char* through);

/// What --mass says. Throws Error(bad_argument).
std::optional<Measure> stated_mass(const SpinOptions& options);

/// Rate that --period or --omega say, in rad/s where it has a unit; a hertz, read as a rad/s, gets a sentence in the notes.
/// Throws Error(bad_argument) for both at once and for what is not above 0.
std::optional<Measure> spin_rate(const SpinOptions& options, std::vector<std::string>& notes);

/// What --spin says. Throws Error(bad_argument).
std::optional<Vec3> spin_axis(const SpinOptions& options);

} // namespace cowgpu::cli
