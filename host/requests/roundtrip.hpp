// What `transform roundtrip` computes: random coefficients to a grid and back.
#pragma once

#include "host/backend.hpp"
#include "host/report/roundtrip_report.hpp"

namespace cowgpu {

/// Grid, device and memory alone; the caller fills in `command` and `notes`. Throws Error(bad_argument, too_large).
RoundtripResult plan_roundtrip(const RoundtripRequest& request, const Backend& backend);

/// Throws what plan_roundtrip() and the transforms throw. An error beyond the bound is a result: see passed().
RoundtripResult roundtrip(const RoundtripRequest& request, Backend& backend, Monitor& monitor);

} // namespace cowgpu
