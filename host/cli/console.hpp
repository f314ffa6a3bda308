// How the program talks: results to stdout, everything else to stderr.
#pragma once

#include "host/monitor.hpp"
#include "host/report/result.hpp"

#include <atomic>
#include <chrono>
#include <string>
#include <string_view>

namespace cowgpu::cli {

/// Set by SIGINT and SIGTERM; long work stops soon after.
extern std::atomic<bool> stop_requested;

/// Catches SIGINT and SIGTERM once (a second one kills) and ignores SIGPIPE and SIGXFSZ, so that a closed pipe or a
/// file-size limit becomes an error of the write.
void catch_signals();

/// Puts /dev/null where standard input, output or error is closed, so that no file of ours gets its number; what stands
/// for standard output cannot be written, which is reported like any other failure.
void open_standard_streams();

/// Writes to standard error, as terminal_text() has it: whatever names and remarks a text holds, a terminal obeys none of
/// it. Nobody is left to tell if that fails, so it is ignored.
void say(std::string_view text);

/// Writes to standard output, as terminal_text() has it; Error(cannot_write) if it is closed or full, Error(interrupted) once a stop is requested.
void write_stdout(std::string_view text);
/// Flushes standard output, with the same error.
void flush_stdout();

/// How progress is shown.
enum class ProgressStyle { none, line, jsonl };

/// "auto": a line on a terminal, nothing elsewhere; "none"; "jsonl": one JSON object a line on stderr.
ProgressStyle progress_style(const std::string& wanted, bool quiet);

/// Shows progress with an estimate of the time left, at most ten times a second and not before a second has passed.
class ConsoleMonitor final : public Monitor {
public:
  explicit ConsoleMonitor(ProgressStyle style) : style_(style) {}
  ~ConsoleMonitor() override { clear(); }
  void progress(const char* what, double fraction) override;
  bool stopped() const override { return stop_requested; }
  /// Removes the line from the terminal.
  void clear();

private:
  using Clock = std::chrono::steady_clock;
  ProgressStyle style_;
  std::string what_;
  Clock::time_point start_ = Clock::now(), last_{};
  bool shown_ = false;
};

} // namespace cowgpu::cli
