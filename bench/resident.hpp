// The most memory that was resident at a time, over what was at the start.
#pragma once

#include <malloc.h>

#include <cmath>
#include <fstream>
#include <string>

namespace cowgpu::bench {

/// On Linux; elsewhere, and where the kernel lets the mark not be reset, it is not known.
class Resident {
public:
  Resident() {
    malloc_trim(0); // else what was freed before is taken again without being seen
    reset_ = bool(std::ofstream("/proc/self/clear_refs") << 5 << std::flush);
    start_ = status("VmRSS:");
  }

  /// In bytes; NaN where it is not known.
  double most() const { return reset_ ? status("VmHWM:") - start_ : std::nan(""); }

private:
  static double status(const std::string& name) {
    std::ifstream file("/proc/self/status");
    std::string word;
    double kilobytes = 0;
    while (file >> word)
      if (word == name && file >> kilobytes) return 1024 * kilobytes;
    return std::nan("");
  }

  bool reset_;
  double start_;
};

} // namespace cowgpu::bench
