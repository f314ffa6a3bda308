// How long work talks to its caller: progress out, a wish to stop in.
#pragma once

namespace cowgpu {

/// Passed down into long work. The default is silent and never stops.
class Monitor {
public:
  virtual ~Monitor() = default;

  /// Work says how far it is; `fraction` in [0, 1], `what` a short phrase with static lifetime. Called from one thread.
  virtual void progress(const char* what, double fraction) {
    (void)what;
    (void)fraction;
  }

  /// True once the user wants to stop. Called from any thread; work then throws Error(Fault::interrupted) soon.
  virtual bool stopped() const { return false; }
};

/// For callers whom nobody watches.
Monitor& silent_monitor();

/// Throws Error(Fault::interrupted) if the monitor says stop.
void check_stop(const Monitor& monitor);

} // namespace cowgpu
