// The Vulkan headers, as the engine uses them: prototypes come from volk at run time.
#pragma once

#include <volk.h>

#include "engine/error.hpp"

namespace cowgpu::engine {

/// Throws Error(vulkan) or Error(device_lost) unless `result` is VK_SUCCESS. `what` is the action: "allocate 3 MiB".
void check(VkResult result, const std::string& what);

} // namespace cowgpu::engine
