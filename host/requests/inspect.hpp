// What is found out about a mesh: its topology, what crosses in it, its sizes, and what it is fit for.
#pragma once

#include "host/monitor.hpp"
#include "host/report/inspection.hpp"

namespace cowgpu {

/// The mesh is judged as it is, on `threads` threads (0: all). Throws Error(mesh_index_range, interrupted).
Inspection inspect(RawMesh mesh, Monitor& monitor, unsigned threads = 0);

} // namespace cowgpu
