#include "host/requests/memory.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

namespace cowgpu {

void check_memory(const MemoryNeed& need, const Backend& backend, const char* advice) {
  const DeviceFacts cpu = make_cpu_backend(1)->facts();
  const bool shared = backend.facts().type == "software" || backend.facts().type == "integrated";
  const std::uint64_t host = need.host + (shared ? need.device : 0);
  if (cpu.memory && host > cpu.memory)
    throw Error(Fault::too_large, fmt::format("this needs {} MiB of memory and the machine has {} MiB; {}", host >> 20,
                                              cpu.memory >> 20, advice));
}

} // namespace cowgpu
