// CPU path of the stage `render`.
#pragma once

#include "host/image.hpp"
#include "host/monitor.hpp"
#include "host/render.hpp"

namespace cowgpu::cpu {

/// Backend::render() on `threads` threads (0: all). Memory beside the image: 450 bytes a face of the largest panel, and up to
/// 100 MB a thread for rays.
Image render(const RenderScene& scene, unsigned threads, Monitor& monitor);

} // namespace cowgpu::cpu
