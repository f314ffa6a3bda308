// A picture of the boundary between tipping and falling back.
#pragma once

#include "host/cli/tip_push.hpp"

#include <string>

namespace cowgpu::cli {

/// Throws Error(bad_argument) for a name that is no picture's.
void check_tip_plot(const std::string& path);

/// How long a constant push must last over how strong it is, with the sustained force and the punch. Throws what
/// plot::write_plot() throws.
void write_tip_plot(const physics::Rocker& rocker, const PushOptions& options, const PushPlan& plan,
                    const Monitor& monitor, const std::string& path);

} // namespace cowgpu::cli
