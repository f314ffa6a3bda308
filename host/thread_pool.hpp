// Threads that stay: for work so short that starting threads would show.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace cowgpu {

/// Persistent threads that share the tasks of one call after the other. A thread that wakes up late finds nothing left
/// to do; nobody waits for it. Not for several callers at once.
class ThreadPool {
public:
  /// `threads` 0: all (all_threads()). The caller is one of them. Has fewer where the system gives no more.
  explicit ThreadPool(unsigned threads = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// Including the caller.
  unsigned threads() const { return unsigned(workers_.size()) + 1; }

  /// Runs body(task, thread) for task = 0 ... tasks-1, each once; tasks are handed out in order, and thread 0 is the
  /// caller. The first exception stops the handing out and is thrown here.
  void run(std::size_t tasks, const std::function<void(std::size_t, unsigned)>& body);

private:
  void serve(unsigned thread);
  void work(unsigned thread);

  // The gate: how many workers are inside a call, and whether it takes no more.
  static constexpr std::uint32_t closed = 0x80000000U;
  std::atomic<std::uint32_t> gate_{closed};
  std::atomic<std::uint32_t> call_{0}; // counts calls; the last one tells the workers to leave
  std::atomic<bool> leave_{false};

  const std::function<void(std::size_t, unsigned)>* body_ = nullptr;
  std::size_t tasks_ = 0;
  alignas(64) std::atomic<std::size_t> next_{0};
  std::mutex error_mutex_;
  std::exception_ptr error_;
  std::vector<std::thread> workers_;
};

} // namespace cowgpu
