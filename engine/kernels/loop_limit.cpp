#include "engine/kernels/loop_limit.hpp"

#include "engine/job.hpp"
#include "shaders/loop_limit.h"
#include "shaders/loop_limit.hpp"

namespace cowgpu::engine {

std::uint32_t loop_iterations(Device& device, std::uint32_t iterations) {
  const Kernel& kernel =
      device.kernel({"loop_limit", shaders::loop_limit, LOOP_LIMIT_BINDINGS, sizeof(shaders::LoopLimitPush), {8}});
  Buffer result(device, 32, "the counts");
  const BufferRange range{&result};
  const shaders::LoopLimitPush push = {iterations};
  Job job(device);
  job.dispatch(kernel, {&range, 1}, std::as_bytes(std::span(&push, 1)), 1);
  job.run();
  std::uint32_t count = 0;
  result.read(std::as_writable_bytes(std::span(&count, 1)));
  return count;
}

} // namespace cowgpu::engine
