#include "host/flow/flow_map.hpp"

#include "host/error.hpp"
#include "host/flow/fixed_steps.hpp"
#include "host/flow/sutures.hpp"
#include "host/map/sample_fields.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/triangle_surface.hpp"
#include "host/paper/recipe.hpp"
#include "host/paper/surface_tables.hpp"
#include "host/reference/flow.hpp"
#include "host/spectrum/power.hpp"
#include "host/spectrum/surface_fields.hpp"
#include "host/sphere_directions.hpp"
#include "tests/support/mapped_meshes.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

struct Row {
  int l, m;
  std::complex<double> f_r;
};

} // namespace

TEST_CASE("the level set is met where the distance is T, and F is the closest point there", "[flow_map]") {
  const auto backend = make_cpu_backend();
  Monitor monitor;
  const RawMesh mesh = together(box({2, 2, 2}, {1, -1, -1}), box({2, 2, 2}, {-3, -1, -1}));
  const Box bounds = bounding_box(mesh.vertices, mesh.faces);
  const auto field = backend->distance_field(mesh.vertices, mesh.faces);
  const Vec3 origin(2, 0, 0);
  const double level = std::sqrt(2) + 1e-6;
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 12);
  const LevelSet set{*field, bounds, origin, level};
  LevelSetReport report;
  const auto positions = level_set_positions(set, grid, monitor, &report);
  CHECK(report.unsettled == 0);
  CHECK(report.largest_residual < 1e-13);
  CHECK(report.least_slope > 0);
  const SphereDirections directions(grid);
  const std::size_t n = grid.points();
  for (std::size_t p = 0; p < n; ++p) {
    const Vec3 u = directions(int(p) / grid.ring_length, int(p) % grid.ring_length);
    const Vec3 closest(positions[p], positions[n + p], positions[2 * n + p]);
    // F and the ray: the far end where |origin + r u - F| = T.
    const Vec3 from = origin - closest;
    const double b = from.dot(u), root = b * b - from.squaredNorm() + level * level;
    REQUIRE(root > -1e-12);
    const Vec3 place = origin + (-b + std::sqrt(std::max(root, 0.0))) * u;
    const double brute = (reference::closest_on_mesh<double>(mesh.vertices, mesh.faces, place) - place).norm();
    CHECK(std::abs(brute - level) < 1e-6 * level); // the root doubles the digits lost where the ray grazes
    CHECK((reference::closest_on_mesh<double>(mesh.vertices, mesh.faces, closest) - closest).norm() < 1e-14);
  }
  CHECK_THROWS_AS(level_set_positions({*field, bounds, origin, 0}, grid, monitor), Error);
}

TEST_CASE("over a ball the level set's map is the identity up to its sagitta", "[flow_map]") {
  const auto backend = make_cpu_backend();
  Monitor monitor;
  double before = 0;
  for (int level = 2; level <= 4; ++level) {
    const RawMesh mesh = icosphere(level, 2);
    ExpandSurfaceOptions options;
    options.lmax = 16;
    options.grid_degree = 256;
    const LevelSetExpansion found = expand_level_set(mesh, 0.5, options, *backend, monitor);
    CHECK(found.time == 0.5);
    CHECK(found.star.lower == 0);
    CHECK(found.level_set.unsettled == 0);
    const double error = 2 * std::sqrt(4 * M_PI) - found.expansion.coefficients.at(0, 0, 0).real();
    CHECK(error > 0);
    if (level > 2) CHECK(std::log2(before / error) == Approx(2).margin(0.2));
    before = error;
  }
}

TEST_CASE("far from the coordinates' zero the level set's uncertainty holds what rounding does", "[flow_map]") {
  const auto backend = make_cpu_backend();
  Monitor monitor;
  ExpandSurfaceOptions options;
  options.lmax = 2;
  options.grid_degree = 256;
  const double away = 1e11;
  const LevelSetExpansion near = expand_level_set(box({1, 1, 1}, {-0.5, -0.5, -0.5}), 0.25, options, *backend, monitor);
  options.origin = {away, 0, 0};
  const LevelSetExpansion far =
      expand_level_set(box({1, 1, 1}, {away - 0.5, -0.5, -0.5}), 0.25, options, *backend, monitor);
  CHECK(near.uncertainty[0][0] < 3.3e-4);
  CHECK(std::isfinite(far.level_set.least_slope));
  for (int l = 0; l <= 2; ++l)
    for (int f = 0; f < 3; ++f) {
      CAPTURE(l, f);
      for (int m = 0; m <= l; ++m)
        CHECK(std::abs(far.expansion.coefficients.at(f, l, m) - near.expansion.coefficients.at(f, l, m)) <=
              far.uncertainty[std::size_t(l)][std::size_t(f)]);
      // Places on the level set are known to 4e-16 of the coordinates over the slope; sqrt(4 pi) makes coefficients of that.
      const double rounding = std::sqrt(4 * M_PI) * 4e-16 * away;
      CHECK(far.uncertainty[std::size_t(l)][std::size_t(f)] <
            near.uncertainty[std::size_t(l)][std::size_t(f)] + 3 * rounding);
    }
}

TEST_CASE("sheets of a map without folds are what rays sample", "[flow_map]") {
  const auto backend = make_cpu_backend();
  Monitor monitor;
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 40); // a ring on the equator, points on edges
  for (const MappedMesh& map : {octahedron_map(), identity_map(2), warped_map(3, 0.01, 4)}) {
    std::vector<Vec3> vertices;
    for (const Vec3& p : map.positions) vertices.push_back((1 + 0.3 * p.x() * p.y()) * p + Vec3(0.1, 0, 0.2) * p.z());
    SheetReport report;
    const auto sheets = sheet_fields(vertices, map.faces, map.positions, grid, Vec3::Zero(), true, monitor, &report);
    CAPTURE(map.name);
    CHECK(report.flipped_faces == 0);
    CHECK(report.folded_points == 0);
    CHECK(std::abs(report.least_degree - 1) < 1e-12);
    CHECK(std::abs(report.largest_degree - 1) < 1e-12);
    const auto sampled = surface_fields(
        sample_positions(backend->sphere_sampler(grid)->sample(map.positions, map.faces, monitor), map.faces, vertices),
        grid, Vec3::Zero(), true);
    REQUIRE(sheets.size() == sampled.size());
    double worst = 0;
    for (std::size_t i = 0; i < sheets.size(); ++i) worst = std::max(worst, std::abs(sheets[i] - sampled[i]));
    CHECK(worst < 1e-12);
  }
}

TEST_CASE("however a map folds, its sheets add up to its degree", "[flow_map]") {
  Monitor monitor;
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 40);
  for (const double size : {0.2, 0.6}) {
    const MappedMesh map = warped_map(3, size, 9);
    const std::vector<Vec3> same(map.positions.size(), Vec3(0, 0, 3)); // f_r is 3 everywhere
    SheetReport report;
    const auto sheets = sheet_fields(same, map.faces, map.positions, grid, Vec3::Zero(), true, monitor, &report);
    CHECK(report.flipped_faces > 50);
    CHECK(report.folded_points > 100);
    CHECK(report.most_sheets >= 3);
    CHECK(std::abs(report.least_degree - 1) < 1e-12);
    CHECK(std::abs(report.largest_degree - 1) < 1e-12);
    for (std::size_t p = 0; p < grid.points(); ++p) CHECK(std::abs(sheets[p] - 3) < 1e-12);
  }
}

TEST_CASE("fixed steps off a convex body are exact", "[flow_map]") {
  const auto backend = make_cpu_backend();
  Monitor monitor;
  const RawMesh mesh = box({1, 2, 3});
  const auto normals = vertex_normals(mesh.vertices, mesh.faces);
  const auto field = backend->distance_field(mesh.vertices, mesh.faces);
  const auto ends = flow_fixed_steps(*field, mesh.vertices, normals, 0.7, 5, monitor);
  for (std::size_t v = 0; v < ends.size(); ++v) CHECK((ends[v] - mesh.vertices[v] - 0.7 * normals[v]).norm() < 1e-14);
  CHECK_THROWS_AS(flow_fixed_steps(*field, mesh.vertices, {}, 0.7, 5, monitor), Error);
  CHECK_THROWS_AS(flow_fixed_steps(*field, mesh.vertices, normals, 0.7, 0, monitor), Error);
}

TEST_CASE("a vertex that flows to the origin has no direction", "[flow_map]") {
  CHECK_THROWS_AS(direction_map(std::vector<Vec3>{Vec3(1, 2, 3)}, {1, 2, 3}), Error);
}

TEST_CASE("the benchmark over its level set at 0.242 has the coefficients that were found before",
          "[flow_map][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto backend = make_cpu_backend();
  Monitor monitor;
  ExpandSurfaceOptions options;
  options.lmax = 128;
  const LevelSetExpansion found = expand_level_set(cow->mesh(), 0.242, options, *backend, monitor);
  CHECK(found.level_set.unsettled == 0);
  CHECK(found.star.upper < 0.242);
  CHECK_FALSE(found.star.given_up);
  CHECK(found.notes.empty());
  CHECK(found.report.rings == 1025);
  for (std::size_t l = 0; l <= 8; ++l)
    for (std::size_t f = 0; f < 6; ++f) {
      CAPTURE(l, f);
      CHECK(found.uncertainty[l][f] > 0);
      CHECK(found.uncertainty[l][f] <= 1e-4);
    }
  // Sutures: jumps in F, and coefficients that fall no faster than those of jumps.
  const LevelSetSutures& sutures = found.sutures;
  CAPTURE(sutures.jumps.length, sutures.jumps.largest, sutures.slopes[0], sutures.slopes[3], found.averaged.cells);
  CHECK(sutures.jumps.largest > 0.3);
  CHECK(sutures.jumps.length > 20);
  CHECK((sutures.slope_from == 16 && sutures.slope_to == 128));
  CHECK(sutures.slopes[3] == Approx(-3).margin(0.3));
  for (const Row& row :
       {Row{0, 0, 1.23552}, Row{1, 1, {0.04453, -0.02123}}, Row{2, 0, -0.30923}, Row{2, 2, {0.09880, -0.09854}},
        Row{3, 1, {0.00924, -0.01455}}, Row{3, 3, {0.01500, 0.08255}}}) {
    CAPTURE(row.l, row.m);
    CHECK(std::abs(found.expansion.coefficients.at(0, row.l, row.m) - row.f_r) < 1e-4);
  }
}

TEST_CASE("the paper's recipe gives the paper's table of the flow as near as discretisations agree",
          "[flow_map][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto backend = make_cpu_backend();
  Monitor monitor;
  const SphereMap map =
      stepped_flow_map(cow->mesh(), Vec3::Zero(), paper::flow_time, paper::flow_step, *backend, monitor);
  ExpandSurfaceOptions options;
  options.lmax = 32;
  options.closest_point = true;
  options.signed_dphi = false;
  const SurfaceExpansion expansion = expand_surface(cow->vertices(), cow->faces(), map, options, *backend, monitor);
  const auto misfits = paper_misfits(expansion, paper_flow_table());
  CAPTURE(misfits[0], misfits[1], misfits[2]);
  CHECK(misfits[0] <= 0.06);
  CHECK(misfits[1] <= 0.05);
  CHECK(misfits[2] <= 0.12);
  CHECK(std::abs(expansion.coefficients.at(0, 0, 0).real() - 1.0750) <= 0.01);
}

namespace {

void check_sheets_of_the_benchmark(int refinements) {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto backend = make_cpu_backend();
  Monitor monitor;
  const auto flow = make_cpu_backend()->distance_flow(cow->vertices(), cow->faces());
  ExpandSurfaceOptions options;
  options.lmax = 64;
  const SheetExpansion found = expand_sheets(cow->mesh(), 0.2, refinements, 1e-6, options, *flow, *backend, monitor);
  REQUIRE(found.levels.size() == std::size_t(refinements) + 1);
  const double expected[3] = {1.0744, 1.0848, 1.0883};
  for (std::size_t k = 0; k < found.levels.size(); ++k) {
    CHECK(found.levels[k].at(0, 0, 0).real() == Approx(expected[k]).margin(5e-4));
    CHECK(std::abs(found.sheets[k].least_degree - 1) < 1e-12);
    CHECK(std::abs(found.sheets[k].largest_degree - 1) < 1e-12);
  }
  CHECK(found.sheets[0].flipped_faces > 1800);
  CHECK(found.expansion.coefficients.at(0, 0, 0).real() == Approx(1.092).margin(refinements > 1 ? 1e-3 : 5e-3));
  CHECK(found.uncertainty[0][0] > 0);
  // At most 0.0143 from one refinement, and less from more.
  for (std::size_t l = 0; l <= 8; ++l)
    for (std::size_t f = 0; f < 6; ++f) {
      CAPTURE(l, f);
      CHECK(found.uncertainty[l][f] <= 0.02);
    }
}

} // namespace

TEST_CASE("signed sheets of the benchmark at 0.2 have the monopoles that were found before", "[flow_map][benchmark]") {
  check_sheets_of_the_benchmark(1);
}

TEST_CASE("signed sheets of the benchmark at 0.2 tend to a monopole of 1.092", "[flow_map][benchmark][long]") {
  check_sheets_of_the_benchmark(2);
}

TEST_CASE("signed sheets of the benchmark at 0.2 are known to 1e-3 up to degree 8 from four refinements",
          "[flow_map][benchmark][deep]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto backend = make_cpu_backend();
  Monitor monitor;
  const auto flow = backend->distance_flow(cow->vertices(), cow->faces());
  ExpandSurfaceOptions options;
  options.lmax = 8;
  const SheetExpansion found = expand_sheets(cow->mesh(), 0.2, 4, 1e-6, options, *flow, *backend, monitor);
  for (std::size_t l = 0; l <= 8; ++l)
    for (std::size_t f = 0; f < 6; ++f) {
      CAPTURE(l, f);
      CHECK(found.uncertainty[l][f] <= 1e-3);
    }
  CHECK(found.expansion.coefficients.at(0, 0, 0).real() == Approx(1.092).margin(1e-3));
}

TEST_CASE("a jump along the equator is one suture of length 2 pi, and slopes of powers are found", "[flow_map]") {
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 31);
  const std::size_t n = grid.points();
  std::vector<double> positions(3 * n);
  for (std::size_t p = 0; p < n; ++p)
    positions[2 * n + p] = grid.theta[p / std::size_t(grid.ring_length)] < M_PI / 2 ? 1 : -0.5;
  const auto step = [](std::span<const Vec3> directions) {
    std::vector<Vec3> ends;
    for (const Vec3& u : directions) ends.emplace_back(0, 0, u.z() > 0 ? 1 : -0.5);
    return ends;
  };
  const SutureReport report = find_sutures(positions, grid, 0.1, step);
  CHECK(report.pairs == std::uint64_t(grid.ring_length));
  CHECK(report.cells == report.pairs);
  CHECK(report.length == Approx(2 * M_PI).epsilon(2e-3)); // of the ring next to the equator
  CHECK(report.largest == 1.5);
  CHECK(find_sutures(positions, grid, 2, step).pairs == 0);
  // As steep as a grid's step, but continuous: no suture.
  const auto steep = [](std::span<const Vec3> directions) {
    std::vector<Vec3> ends;
    for (const Vec3& u : directions) ends.emplace_back(0, 0, std::clamp(1e3 * u.z(), -0.5, 1.0));
    return ends;
  };
  CHECK(find_sutures(positions, grid, 0.1, steep).pairs == 0);
  std::vector<double> falling(100, 1);
  for (std::size_t l = 1; l < 100; ++l) falling[l] = double(2 * l + 1) * std::pow(double(l), -3);
  CHECK(spectral_slope(falling, 10, 99) == Approx(-3).epsilon(1e-12));
  CHECK_THROWS_AS(spectral_slope(falling, 10, 100), Error);
  CHECK_THROWS_AS(find_sutures(positions, grid, 0, step), Error);
}

TEST_CASE("means over the cells at jumps bring the grid's error down, and leave smooth fields alone", "[flow_map]") {
  const auto backend = make_cpu_backend();
  Monitor monitor;
  const RawMesh two = together(box({2, 2, 2}, {1, -1, -1}), box({2, 2, 2}, {-3, -1, -1})), one = test::icosphere(4);
  ExpandSurfaceOptions options;
  options.lmax = 8;
  options.origin = {2, 0.1, 0.2};
  const auto of = [&](const RawMesh& mesh, const Vec3& origin, int degree, int parts, CellMeansReport& jumps) {
    const Box bounds = bounding_box(mesh.vertices, mesh.faces);
    const auto field = backend->distance_field(mesh.vertices, mesh.faces);
    const SphereGrid grid = make_grid(GridKind::gauss_legendre, degree);
    const LevelSet set{*field, bounds, origin, 1.6};
    const auto positions = level_set_positions(set, grid, monitor);
    const auto values =
        cell_mean_fields(set, mesh.vertices, mesh.faces, grid, positions, true, {.parts = parts}, monitor, &jumps);
    SphereCoefficients a(8, 6);
    backend->sphere_transform(grid, 8)->analyse(6, values, a.values, monitor);
    return a;
  };
  const auto largest = [](const SphereCoefficients& a, const SphereCoefficients& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.values.size(); ++i) most = std::max(most, std::abs(a.values[i] - b.values[i]));
    return most;
  };
  CellMeansReport jumps;
  const SphereCoefficients truth = of(two, options.origin, 1024, 4, jumps);
  const double plain = largest(of(two, options.origin, 128, 1, jumps), truth);
  CHECK((jumps.cells > 100 && jumps.cells < jumps.points / 10));
  const double averaged = largest(of(two, options.origin, 128, 4, jumps), truth);
  CAPTURE(plain, averaged);
  CHECK(averaged < plain / 10);
  const double moved = largest(of(one, {0, 0, 0}, 128, 4, jumps), of(one, {0, 0, 0}, 128, 1, jumps));
  CAPTURE(moved);
  CHECK(moved < plain / 40);
}
