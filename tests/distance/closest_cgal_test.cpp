// Against CGAL's tree of boxes: distances in double precision, sides by exact predicates.
#include "tests/support/cgal_distance.hpp"
#include "tests/support/compare_closest.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

// `simple`: the surface does not intersect itself, so that CGAL knows its inside.
void compare_with_cgal(Paths& paths, const RawMesh& mesh, std::size_t count, bool simple) {
  const CgalTree cgal(mesh.vertices, mesh.faces);
  std::vector<Vec3> queries = queries_in_box(mesh, count, 1.1, 1);
  for (const auto& more : {queries_near_surface(mesh, count, 0.02, 2), queries_at_edges(mesh, count / 10, 3)})
    queries.insert(queries.end(), more.begin(), more.end());
  paths.each([&](Backend& backend) {
    INFO(backend.facts().type << ", " << mesh.faces.size() << " faces");
    const ClosestPoints found = closest(backend, mesh, queries);
    double worst = 0;
    std::size_t wrong = 0, near = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const double d = (cgal.closest(queries[i]) - queries[i]).norm();
      worst = std::max(worst, std::abs(std::abs(found.distance[i]) - d));
      if (!simple) continue;
      const int side = cgal.side(queries[i]);
      near += side == 0 || found.distance[i] == 0;
      wrong += side != 0 && found.distance[i] != 0 && (found.distance[i] < 0) != (side == 1);
    }
    check_at_most(worst / diagonal(mesh), 1e-14, "distance from CGAL's, of the diagonal");
    CHECK(wrong == 0);
    CHECK(near < queries.size() / 10);
  });
}

} // namespace

TEST_CASE("distances and signs are those of CGAL", "[closest][cgal]") {
  Paths paths;
  compare_with_cgal(paths, icosphere(3), 20000, true);
  compare_with_cgal(paths, torus(60, 30), 20000, true);
  compare_with_cgal(paths, shell_with_cavity(), 20000, true);
  if (const auto bull = demo_body("bull")) compare_with_cgal(paths, bull->mesh(), 20000, false);
}

TEST_CASE("distances from the benchmark are those of CGAL", "[closest][cgal]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  Paths paths;
  compare_with_cgal(paths, cow->mesh(), 50000, false);
}
