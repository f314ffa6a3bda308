#include "tests/support/compare_flows.hpp"

#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

namespace cowgpu::test {

RawMesh two_balls(int level, double distance) {
  const RawMesh ball = translated(icosphere(level), {distance, 0, 0});
  return together(ball, flipped(scaled(ball, {-1, 1, 1})));
}

void check_same(const FlowPoints& a, const FlowPoints& b) {
  CHECK((a.positions == b.positions && a.distances == b.distances && a.faces == b.faces && a.flags == b.flags));
  CHECK((a.slide_times == b.slide_times && a.slide_places == b.slide_places && a.queries == b.queries));
  CHECK((a.first == b.first && a.path == b.path && a.path_times == b.path_times));
}

} // namespace cowgpu::test
