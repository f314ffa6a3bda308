// The CPU path of the verbs `analyse` and `synthesise`.
#pragma once

#include "host/sphere_transform.hpp"

#include <memory>

namespace cowgpu::cpu {

/// On `threads` threads (0: all).
std::unique_ptr<SphereTransform> sphere_transform(const SphereGrid& grid, int lmax, unsigned threads);

} // namespace cowgpu::cpu
