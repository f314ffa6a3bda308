#include "host/requests/distance.hpp"

#include "host/error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/refusals.hpp"

#include <catch2/catch.hpp>

using namespace cowgpu;
using namespace cowgpu::test;

TEST_CASE("distances are found by a call, of points and of a lattice", "[distance][requests]") {
  const auto backend = make_cpu_backend();
  DistanceRequest request;
  request.mesh = box({1, 1, 1});
  request.points = {{0.5, 0.5, 0.75}, {2, 0.5, 0.5}};
  DistancePlan plan(request, silent_monitor());
  CHECK(plan.count == 2);
  CHECK(plan.memory(*backend).host > 0);
  CHECK(find_distances(std::move(plan), *backend, silent_monitor()).points.distance == std::vector<double>{-0.25, 1});

  request.lattice = 3;
  const DistanceResult lattice = find_distances(DistancePlan(request, silent_monitor()), *backend, silent_monitor());
  REQUIRE(lattice.lattice);
  CHECK(lattice.queries.size() == 27);
  CHECK(lattice.points.distance[13] == Approx(-0.5)); // in the middle

  request.mesh.faces.pop_back();
  CHECK_THROWS_AS(DistancePlan(request, silent_monitor()), Error);
  request.with_sign = false;
  CHECK(DistancePlan(request, silent_monitor()).count == 27);
}

TEST_CASE("lattices beyond the bounds of the command line are refused by the call", "[distance][requests]") {
  for (const std::size_t side : {std::size_t(1), std::size_t(4097), std::size_t(4'000'000'000)}) {
    DistanceRequest request;
    request.mesh = box({1, 1, 1});
    request.lattice = side;
    refuses([&] { DistancePlan(request, silent_monitor()); }, "2 to 4096 are possible");
  }
}

TEST_CASE("a mesh from arrays is the mesh in messages", "[distance][requests]") {
  DistanceRequest request;
  request.mesh = box({1, 1, 1});
  request.mesh.name.clear();
  request.mesh.faces.pop_back();
  try {
    DistancePlan(request, silent_monitor());
    FAIL("an open mesh was taken");
  } catch (const Error& error) {
    CHECK_THAT(error.what(), Catch::StartsWith("the mesh: "));
  }
}
