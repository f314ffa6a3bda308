// The fast sum of the verb `polyhedron` on a device (host/plan/polyhedron_fast.hpp): the near faces there, and where it is no
// software device the multipoles' way to local expansions; trees, lists of pairs and the rest on the host meanwhile.
#pragma once

#include "engine/gpu.hpp"
#include "host/gpu/polyhedron.hpp"
#include "host/polyhedron.hpp"

#include <memory>

namespace cowgpu::gpu {

/// Keeps the device open. As cpu::fast_polyhedron(), but near faces are always summed to rounding.
std::unique_ptr<PreparedPolyhedron> fast_polyhedron(std::shared_ptr<engine::Gpu> gpu, const PolyhedronLayout& layout,
                                                    const PolyhedronProblem& problem);

} // namespace cowgpu::gpu
