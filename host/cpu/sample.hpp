// CPU path of the stage `sample`: bands of rings on all cores, each scanned triangle by triangle.
#pragma once

#include "host/monitor.hpp"
#include "host/run_report.hpp"
#include "host/sphere_grid.hpp"
#include "host/sphere_samples.hpp"
#include "host/types.hpp"

#include <span>

namespace cowgpu::cpu {

/// Backend::sample on `threads` threads (0: all). The bits depend on neither threads nor instruction set.
SphereSamples sample(std::span<const Vec3> positions, std::span<const Face> faces, const SphereGrid& grid,
                     unsigned threads, Monitor& monitor, RunReport* report);

/// Bound of the bytes sample() allocates, its result included.
std::uint64_t sample_bytes(std::uint64_t faces, const SphereGrid& grid);

} // namespace cowgpu::cpu
