#include "host/parallel.hpp"

#include "host/bounds.hpp"
#include "host/signals.hpp"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace cowgpu {

unsigned all_threads() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) == 0) return std::max(1, CPU_COUNT(&set));
  return std::max(1U, std::thread::hardware_concurrency());
}

void parallel_for(unsigned threads, std::size_t tasks, const std::function<void(std::size_t, unsigned)>& body) {
  if (threads == 0) threads = all_threads();
  threads = unsigned(std::min<std::size_t>(std::min(threads, most_threads), tasks));
  if (threads <= 1) {
    for (std::size_t task = 0; task < tasks; ++task) body(task, 0);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::exception_ptr error;
  std::mutex error_mutex;
  const auto work = [&](unsigned thread) {
    try {
      for (std::size_t task = next++; task < tasks; task = next++) body(task, thread);
    } catch (...) {
      next = tasks;
      const std::lock_guard lock(error_mutex);
      if (!error) error = std::current_exception();
    }
  };
  std::vector<std::jthread> pool;
  try {
    const HeldSignals for_the_caller;
    for (unsigned t = 1; t < threads; ++t) pool.emplace_back(work, t);
  } catch (const std::system_error&) {
    // No more threads to be had: those there are do the work.
  }
  work(0);
  pool.clear();
  if (error) std::rethrow_exception(error);
}

} // namespace cowgpu
