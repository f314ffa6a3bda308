#include "engine/kernels/peak.hpp"

#include "engine/job.hpp"
#include "shaders/peak.h"
#include "shaders/peak.hpp"

#include <algorithm>
#include <chrono>

namespace cowgpu::engine {

double peak(Device& device) {
  const std::uint32_t width = device.software() ? device.physical().subgroup_size : 256;
  const std::uint32_t groups = device.software() ? 64 : 4096;
  const Kernel& kernel = device.kernel({"peak", shaders::peak, PEAK_BINDINGS, sizeof(shaders::PeakPush), {width}});
  Buffer result(device, std::uint64_t(8) * width * groups, "the result");
  const BufferRange range{&result};
  double best = 0;
  std::uint32_t rounds = 64;
  for (int run = 0; run < 8; ++run) {
    const shaders::PeakPush push = {0.999, 0.001, rounds};
    Job job(device);
    job.dispatch(kernel, {&range, 1}, std::as_bytes(std::span(&push, 1)), groups);
    const auto start = std::chrono::steady_clock::now();
    job.run();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double flops = 2.0 * 8 * PEAK_CHAINS * rounds * width * groups;
    // The first run compiles; the next ones settle on about 20 ms a dispatch.
    if (run > 0) best = std::max(best, flops / seconds);
    if (run > 0 && seconds < 0.02) rounds = std::min<std::uint32_t>(rounds * 2, 60000);
  }
  return best;
}

} // namespace cowgpu::engine
