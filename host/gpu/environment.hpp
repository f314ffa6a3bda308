// What a Vulkan driver is told through the environment.
#pragma once

namespace cowgpu::gpu {

/// Gives Mesa's shader cache a folder of its own ($XDG_CACHE_HOME/cowgpu or ~/.cache/cowgpu) unless the user chose one, so
/// that shaders compile once. The folder's name holds LP_NATIVE_VECTOR_WIDTH, which Mesa's cache key leaves out. Where that
/// folder is another user's or open to all there is no cache, since it holds machine code. To be called before the first Vulkan call, while one thread runs.
void prepare_environment();

} // namespace cowgpu::gpu
