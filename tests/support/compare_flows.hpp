// What the tests of the verb `flow` share.
#pragma once

#include "host/flow.hpp"
#include "host/mesh/raw_mesh.hpp"

namespace cowgpu::test {

/// Two balls of radius 1 about (-distance, 0, 0) and (distance, 0, 0), mirror images: what starts between them slides.
RawMesh two_balls(int level, double distance);

/// The same bits.
void check_same(const FlowPoints& a, const FlowPoints& b);

} // namespace cowgpu::test
