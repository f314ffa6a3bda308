// The CPU path of the verb `polyhedron`.
#pragma once

#include "host/polyhedron.hpp"

#include <memory>

namespace cowgpu::cpu {

std::unique_ptr<PreparedPolyhedron> polyhedron(const PolyhedronProblem& problem, unsigned threads);

} // namespace cowgpu::cpu
