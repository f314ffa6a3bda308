// CPU path of the stage `render`.
#pragma once

#include "host/image.hpp"
#include "host/monitor.hpp"
#include "host/render.hpp"

namespace cowgpu::cpu {

/// Backend::render() on `threads` threads (0: all). Memory beside the image: 400 bytes a face of the largest panel.
Image render(const RenderScene& scene, unsigned threads, Monitor& monitor);

} // namespace cowgpu::cpu
