#include "host/requests/map.hpp"

#include "host/error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/refusals.hpp"

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

TEST_CASE("maps beyond the bounds of the command line are refused by the call", "[map][requests]") {
  const auto with = [](auto&& set) {
    return [set] {
      MapRequest request;
      request.mesh = test::icosphere(1);
      set(request);
      make_map(std::move(request), silent_monitor());
    };
  };
  refuses(with([](MapRequest& r) { r.relabellings = 4'000'000'000U; }),
          "the copies of the body are 4000000000: 0 to 10000");
  refuses(with([](MapRequest& r) { r.lmax = 0; }), "is 0: 1 to 8192");
  refuses(with([](MapRequest& r) { r.method = StretchOptions{2'000'000}; }), "the sweeps are 2000000");
  refuses(with([](MapRequest& r) {
            HarmonicOptions how;
            how.weights = EdgeWeights(17);
            r.method = how;
          }),
          "the weights of edges are number 17");
  refuses(with([](MapRequest& r) {
            HarmonicOptions how;
            how.pole.rule = Pole::Rule(3);
            r.method = how;
          }),
          "the rule for the pole is number 3");
}
