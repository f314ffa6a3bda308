#include "host/signals.hpp"

namespace cowgpu {

const std::vector<int>& ending_signals() {
  static const std::vector<int> all = [] {
    std::vector<int> list = {SIGHUP,    SIGINT,  SIGTERM, SIGUSR1, SIGUSR2, SIGALRM,
                             SIGVTALRM, SIGPROF, SIGXCPU, SIGIO,   SIGPWR,  SIGSTKFLT};
    for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) list.push_back(signal);
    return list;
  }();
  return all;
}

HeldSignals::HeldSignals() {
  sigset_t held;
  sigemptyset(&held);
  for (const int signal : ending_signals()) sigaddset(&held, signal);
  pthread_sigmask(SIG_BLOCK, &held, &before_);
}

HeldSignals::~HeldSignals() {
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

KeptAction::KeptAction(int signal) : signal_(signal) {
  sigaction(signal_, nullptr, &action_);
}

KeptAction::~KeptAction() {
  sigaction(signal_, &action_, nullptr);
}

} // namespace cowgpu
