// CPU path of the stage `sample`: bands of rings on all cores, each scanned triangle by triangle.
#pragma once

#include "host/sphere_grid.hpp"
#include "host/sphere_samples.hpp"

#include <memory>

namespace cowgpu::cpu {

/// Backend::sphere_sampler on `threads` threads (0: all). The bits depend on neither threads nor instruction set.
std::unique_ptr<SphereSampler> sphere_sampler(const SphereGrid& grid, unsigned threads);

} // namespace cowgpu::cpu
