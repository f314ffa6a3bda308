#include "host/requests/inflate.hpp"
#include "host/requests/render.hpp"
#include "host/requests/streamlines.hpp"

#include "host/error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/refusals.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

TEST_CASE("a body is inflated by a call, and drawn", "[inflate][requests]") {
  const auto backend = make_cpu_backend();
  InflateRequest request;
  request.mesh = box({1, 2, 3});
  request.levels = {0.5, 1.0};
  request.star = true;
  request.cells = 24;
  CHECK(inflate_memory(request, *backend).host > 0);
  std::vector<double> told;
  const InflateResult result =
      inflate(request, *backend, silent_monitor(), [&](InflatedBody& body) { told.push_back(body.level); });
  CHECK(told == std::vector<double>{0.5, 1});
  REQUIRE(result.star);
  CHECK(result.star->lower == 0); // a box is star-shaped as it is
  REQUIRE(result.bodies.size() == 2);
  const double volume = 6 + 22 * 0.5 + std::numbers::pi * 6 * 0.25 + 4. / 3 * std::numbers::pi * 0.125; // Steiner
  CHECK(*result.bodies[0].audit.volume == Approx(volume).epsilon(0.02));
  CHECK(result.bodies[0].audit.closed);

  const Image image =
      draw_picture({{result.bodies[0].surface, result.bodies[1].surface}, {parse_view("iso")}, {20, 10, 0, false}},
                   *backend, silent_monitor());
  CHECK(image.width == 40);
  CHECK(image.height == 10);

  request.levels = {std::nullopt};
  CHECK_THROWS_AS(inflate(request, *backend, silent_monitor()), Error); // nothing to show of a star-shaped body
  request.levels = {1e-6};
  CHECK_THROWS_AS(inflate(request, *backend, silent_monitor()), Error);
}

TEST_CASE("streamlines are found by a call", "[streamlines][requests]") {
  const auto backend = make_cpu_backend();
  StreamlinesRequest request;
  request.mesh = box({2, 2, 2}, {-1, -1, -1});
  request.plane = parse_plane("xy");
  request.count = 8;
  request.time = 0.5;
  const StreamlinesResult result = find_streamlines(request, *backend, silent_monitor());
  CHECK(result.table.cut.size() == 1);
  CHECK(result.table.cut[0].length == Approx(8));
  CHECK(result.table.found.lines.positions.size() == 8);
  for (const Vec3& end : result.table.found.lines.positions)
    CHECK(end.cwiseAbs().maxCoeff() == Approx(1.5)); // half a side's length off the side that it started on

  request.plane.offset = 7;
  CHECK_THROWS_AS(find_streamlines(request, *backend, silent_monitor()), Error);
  request.plane.offset = 0;
  request.space = 1e-9;
  CHECK_THROWS_AS(find_streamlines(request, *backend, silent_monitor()), Error);
}

TEST_CASE("levels and streamlines beyond the bounds of the command line are refused by the calls", "[requests]") {
  const auto backend = make_cpu_backend();
  for (const int cells : {3, 1025}) {
    InflateRequest request;
    request.mesh = box({1, 2, 3});
    request.levels = {0.5};
    request.cells = cells;
    refuses([&] { inflate(request, *backend, silent_monitor()); }, "4 to 1024 are possible");
  }
  const auto with = [&](auto&& set) {
    return [&, set] {
      StreamlinesRequest request;
      request.mesh = box({2, 2, 2}, {-1, -1, -1});
      request.plane = parse_plane("xy");
      set(request);
      find_streamlines(std::move(request), *backend, silent_monitor());
    };
  };
  refuses(with([](StreamlinesRequest& r) { r.count = 0; }), "the lines are 0: 1 to 1000000");
  refuses(with([](StreamlinesRequest& r) { r.count = 2'000'000; }), "the lines are 2000000");
  refuses(with([](StreamlinesRequest& r) { r.time = -1; }), "the time is -1");
  refuses(with([](StreamlinesRequest& r) { r.space = 0; }), "the spacing is 0");
  refuses(with([](StreamlinesRequest& r) { r.within = std::nan(""); }),
          "the distance of vertices from the plane is nan");
  refuses(with([](StreamlinesRequest& r) { r.tolerance = 1; }), "the tolerance is 1: 1e-12 to 0.01");
}
