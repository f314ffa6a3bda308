// Threads for the CPU paths.
#pragma once

#include <cstddef>
#include <functional>

namespace cowgpu {

/// Threads the CPU paths use when asked for 0: what this process may run on (its affinity mask), at least 1.
unsigned all_threads();

/// Runs body(task, thread) for task = 0 ... tasks-1, each once, on up to `threads` threads (0: all); tasks are handed out
/// in order. The first exception stops the handing out and is thrown here.
void parallel_for(unsigned threads, std::size_t tasks, const std::function<void(std::size_t, unsigned)>& body);

} // namespace cowgpu
