// Whether this machine has the memory that work needs.
#pragma once

#include "host/backend.hpp"

namespace cowgpu {

/// Throws Error(too_large), with `advice` on what to ask for instead, where this machine has less than the work needs.
void check_memory(const MemoryNeed& need, const Backend& backend, const char* advice);

} // namespace cowgpu
