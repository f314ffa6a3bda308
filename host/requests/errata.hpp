// The numbers that show what is wrong in "Higher multipoles of the cow".
#pragma once

#include "host/mesh/raw_mesh.hpp"
#include "host/monitor.hpp"
#include "host/report/errata_report.hpp"

#include <optional>

namespace cowgpu {

/// Computes them on the CPU: those that follow from the paper's own numbers and formulas and, with the paper's mesh
/// (`benchmark`), those that take it. Throws what ClosedSurface::from() and the maps throw, Error(interrupted).
ErrataResult find_errata(std::optional<RawMesh> benchmark, Monitor& monitor);

} // namespace cowgpu
