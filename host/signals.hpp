// Signals: those that end a process, and the threads that leave them to another one.
#pragma once

#include <csignal>
#include <vector>

namespace cowgpu {

/// Signals that others send to end a process, or whose default ends it: hang-up, interrupt, termination, user signals,
/// timers, limits of time, real-time signals. Not among them are those that tell of a fault of the program itself, SIGQUIT,
/// which is for a core dump on the spot, and SIGPIPE and SIGXFSZ, which are better told by the call that fails.
const std::vector<int>& ending_signals();

/// As long as one lives, the calling thread and the threads it starts meanwhile get none of the ending signals; a thread
/// keeps this to its end. A signal to the process goes to another thread or, where there is none, waits.
class HeldSignals {
public:
  HeldSignals();
  ~HeldSignals();
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

private:
  sigset_t before_{};
};

/// Puts back at its end what a signal did at its beginning, whatever a library has done to it meanwhile.
class KeptAction {
public:
  explicit KeptAction(int signal);
  ~KeptAction();
  KeptAction(const KeptAction&) = delete;
  KeptAction& operator=(const KeptAction&) = delete;

private:
  int signal_;
  struct sigaction action_ {};
};

} // namespace cowgpu
