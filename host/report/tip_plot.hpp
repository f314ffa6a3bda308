// A picture of the boundary between tipping and falling back.
#pragma once

#include "host/monitor.hpp"
#include "host/plot/plot.hpp"
#include "host/report/push_findings.hpp"

namespace cowgpu {

/// How long a constant push must last over how strong it is, with the sustained force and the punch.
plot::Plot tip_plot(const PushOutcome& outcome, const Monitor& monitor);

} // namespace cowgpu
