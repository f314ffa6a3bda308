#include "host/cli/console.hpp"

#include "host/cli/stop.hpp"
#include "host/error.hpp"
#include "host/io/shown.hpp"
#include "host/signals.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>

namespace cowgpu::cli {

std::atomic<bool> stop_requested{false};

namespace {

std::atomic<int> stop_signal{0};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<double>::is_always_lock_free);

double seconds_now() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// Who asks again is impatient. A signal that comes twice at once, to the process and to its group, is one wish.
extern "C" void on_signal(int signal) {
  constexpr double twice_at_once = 0.3;
  static std::atomic<double> first_interrupt{0}, first_termination{0};
  const int error = errno;
  int none = 0;
  stop_signal.compare_exchange_strong(none, signal);
  stop_requested = true;
  if (signal == SIGINT || signal == SIGTERM) {
    double never = 0;
    const double now = seconds_now();
    if (!(signal == SIGINT ? first_interrupt : first_termination).compare_exchange_strong(never, now) &&
        now - never > twice_at_once) {
      std::signal(signal, SIG_DFL);
      raise(signal); // which waits until this handler returns
    }
  }
  errno = error;
}

// What moves the cursor: the line of progress alone.
void say_raw(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
}

[[noreturn]] void stdout_failed() {
  throw Error(Fault::cannot_write, fmt::format("standard output cannot be written: {}", std::strerror(errno)));
}

} // namespace

void open_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(fd, F_GETFD) < 0 && errno == EBADF) open("/dev/null", fd == STDERR_FILENO ? O_WRONLY : O_RDONLY);
}

void say(std::string_view text) {
  say_raw(terminal_text(text));
}

void catch_signals() {
  // Without SA_RESTART, so that a read that waits for a pipe ends too.
  struct sigaction action {
  }, there{};
  action.sa_handler = on_signal;
  for (const int signal : ending_signals())
    if (sigaction(signal, nullptr, &there) == 0 && !(there.sa_flags & SA_SIGINFO) && there.sa_handler == SIG_DFL)
      sigaction(signal, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int stop_exit_code() {
  return stop_signal == 0 ? exit_code(Fault::interrupted) : 128 + stop_signal;
}

std::string stop_reason() {
  const char* name = stop_signal == 0 || stop_signal == SIGINT ? nullptr : sigdescr_np(stop_signal);
  return name ? fmt::format(" ({})", name) : "";
}

void write_stdout(std::string_view text) {
  if (stop_requested) throw Error(Fault::interrupted, "interrupted while the result was written");
  const std::string safe = terminal_text(text);
  if (std::fwrite(safe.data(), 1, safe.size(), stdout) != safe.size()) stdout_failed();
}

void flush_stdout() {
  if (std::fflush(stdout) != 0) stdout_failed();
}

ProgressStyle progress_style(const std::string& wanted, bool quiet) {
  if (wanted == "jsonl") return ProgressStyle::jsonl;
  if (wanted == "none" || quiet || !isatty(STDERR_FILENO)) return ProgressStyle::none;
  return ProgressStyle::line;
}

void ConsoleMonitor::progress(const char* what, double fraction) {
  if (style_ == ProgressStyle::none) return;
  const auto now = Clock::now();
  if (what_ != what) {
    if (!what_.empty()) start_ = now; // the first phase began with the monitor
    what_ = what;
  }
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  if (elapsed < 1 || now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  const double left = fraction > 0 ? elapsed * (1 - fraction) / fraction : 0;
  if (style_ == ProgressStyle::jsonl) {
    const nlohmann::json line = {{"what", what}, {"fraction", fraction}, {"seconds", elapsed}, {"seconds_left", left}};
    say(fmt::format("{}\n", line.dump()));
    return;
  }
  constexpr int width = 30;
  const int full = int(width * fraction);
  say_raw(fmt::format("\r{} [{}{}] {:3.0f} %, {:.0f} s, about {:.0f} s left\033[K", what,
                      std::string(std::size_t(full), '#'), std::string(std::size_t(width - full), ' '), 100 * fraction,
                      elapsed, left));
  std::fflush(stderr);
  shown_ = true;
}

void ConsoleMonitor::clear() {
  if (shown_) say_raw("\r\033[K");
  std::fflush(stderr);
  shown_ = false;
}

} // namespace cowgpu::cli
