#include "host/requests/map.hpp"

#include "host/error.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

using namespace cowgpu;
using namespace cowgpu::test;

TEST_CASE("a map is made and judged by a call, by each method", "[map][requests]") {
  MapRequest request;
  request.mesh = test::icosphere(2);
  request.lmax = 8;
  const auto check_one = [&](MapMethod method) {
    const MapResult result = make_map(request, silent_monitor());
    INFO(name(method));
    CHECK(result.map.method == method);
    CHECK(result.map.positions.size() == request.mesh.vertices.size());
    CHECK(result.quality.flipped.empty());
    CHECK(result.stretch.has_value() == (method == MapMethod::stretch));
    CHECK(result.flow.has_value() == (method == MapMethod::flow));
    check_map(result);
  };
  check_one(MapMethod::stretch);
  request.method = HarmonicOptions{};
  check_one(MapMethod::harmonic);
  request.method = SmoothOptions{};
  check_one(MapMethod::smooth);
  request.method = FlowMapOptions{0.5, {"mesh", Vec3::Zero()}};
  check_one(MapMethod::flow);
  request.mesh = two_shells();
  CHECK_THROWS_AS(make_map(request, silent_monitor()), Error);
}
