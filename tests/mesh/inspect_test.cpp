#include "host/requests/inspect.hpp"

#include "host/error.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

using namespace cowgpu;
using namespace cowgpu::test;

TEST_CASE("a mesh is inspected by a call: two boxes that overlap", "[inspect]") {
  Monitor monitor;
  const Inspection found = inspect(together(box({2, 2, 2}, {-1, -1, -1}), box({2, 2, 2}, {0, 0, 0})), monitor);
  CHECK(found.moments == "yes");
  CHECK(found.maps.find("no [") == 0); // two shells are no sphere
  CHECK(found.audit.components == 2);
  REQUIRE(found.intersections);
  CHECK(found.intersections->complete);
  CHECK(found.intersections->crossing > 0);
  REQUIRE(found.overlap);
  CHECK(found.overlap->overlapped.volume == Approx(1).epsilon(1e-9));
  REQUIRE(found.largest_ball);
  CHECK(found.largest_ball->radius == Approx(1).epsilon(1e-3));
}

TEST_CASE("an inspection of a mesh with a hole says what it is unfit for", "[inspect]") {
  Monitor monitor;
  RawMesh open = box({1, 1, 1});
  open.faces.pop_back();
  const Inspection found = inspect(open, monitor);
  CHECK(found.moments.find("no [") == 0);
  CHECK(found.maps.find("no [") == 0);
  CHECK_FALSE(found.overlap);
  CHECK(found.audit.open_edges == 3);
  open.faces.push_back({0, 1, 99});
  CHECK_THROWS_AS(inspect(open, monitor), Error);
}
