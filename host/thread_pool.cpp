#include "host/thread_pool.hpp"

#include "host/parallel.hpp"
#include "host/signals.hpp"

#include <system_error>
#include <utility>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace cowgpu {
namespace {

// Some tens of microseconds: longer than the gap between two stages, shorter than a user's patience.
constexpr int spins = 1000;

void pause_briefly() {
#if defined(__x86_64__)
  _mm_pause();
#endif
}

// Waits until `value` is no longer `old`, awake at first, then asleep. Returns the new value.
std::uint32_t wait_for_change(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  for (int spin = 0; spin < spins; ++spin) {
    if (const std::uint32_t now = value.load(std::memory_order_acquire); now != old) return now;
    pause_briefly();
  }
  value.wait(old, std::memory_order_acquire);
  return value.load(std::memory_order_acquire);
}

} // namespace

ThreadPool::ThreadPool(unsigned threads) {
  if (threads == 0) threads = all_threads();
  workers_.reserve(threads - 1);
  const HeldSignals for_the_caller;
  try {
    for (unsigned t = 1; t < threads; ++t) workers_.emplace_back([this, t] { serve(t); });
  } catch (const std::system_error&) {
    // No more threads to be had: those there are do the work.
  }
}

ThreadPool::~ThreadPool() {
  leave_ = true;
  ++call_;
  call_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::serve(unsigned thread) {
  for (std::uint32_t seen = 0;;) {
    seen = wait_for_change(call_, seen);
    if (leave_) return;
    if (!(gate_.fetch_add(1) & closed)) work(thread);
    if (gate_.fetch_sub(1) == (closed | 1)) gate_.notify_one();
  }
}

void ThreadPool::work(unsigned thread) {
  try {
    for (std::size_t task = next_++; task < tasks_; task = next_++) (*body_)(task, thread);
  } catch (...) {
    next_ = tasks_;
    const std::lock_guard lock(error_mutex_);
    if (!error_) error_ = std::current_exception();
  }
}

void ThreadPool::run(std::size_t tasks, const std::function<void(std::size_t, unsigned)>& body) {
  if (workers_.empty() || tasks <= 1) {
    for (std::size_t task = 0; task < tasks; ++task) body(task, 0);
    return;
  }
  body_ = &body;
  tasks_ = tasks;
  next_ = 0;
  gate_.fetch_and(~closed);
  ++call_;
  call_.notify_all();
  work(0);
  std::uint32_t inside = gate_.fetch_or(closed) | closed;
  while (inside != closed) inside = wait_for_change(gate_, inside);
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

} // namespace cowgpu
