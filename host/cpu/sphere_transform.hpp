// The CPU path of the verbs `analyse` and `synthesise`.
#pragma once

#include "host/run_report.hpp"
#include "host/sphere_transform.hpp"

#include <memory>

namespace cowgpu::cpu {

std::unique_ptr<SphereTransform> sphere_transform(const SphereGrid& grid, int lmax, unsigned threads);
MemoryNeed sphere_transform_memory(const SphereGrid& grid, int lmax, int fields, unsigned threads);

} // namespace cowgpu::cpu
