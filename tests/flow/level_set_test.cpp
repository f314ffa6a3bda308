#include "host/backend.hpp"
#include "host/error.hpp"
#include "host/flow/flow_map.hpp"
#include "host/flow/level_set.hpp"
#include "host/mesh/builtin.hpp"
#include "host/mesh/geometry.hpp"
#include "host/sphere_directions.hpp"
#include "tests/support/cpu_with_a_fault.hpp"
#include "tests/support/level_set_reference.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <numbers>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;

namespace {

// The prism over [0,2] x [0,2] less ]1,2] x ]1,2], 0 <= z <= 1: star-shaped about the points of [0,1] x [0,1] x [0,1].
RawMesh l_prism() {
  RawMesh mesh;
  const std::vector<std::array<double, 2>> corners = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const double z : {0., 1.})
    for (const auto& c : corners) mesh.vertices.emplace_back(c[0], c[1], z);
  for (const Face& f : {Face{0, 1, 3}, Face{1, 2, 3}, Face{0, 3, 5}, Face{3, 4, 5}}) {
    mesh.faces.push_back({f[0], f[2], f[1]});
    mesh.faces.push_back({f[0] + 6, f[1] + 6, f[2] + 6});
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    mesh.faces.push_back({i, j, j + 6});
    mesh.faces.push_back({i, j + 6, i + 6});
  }
  return mesh;
}

// A ball whose vertices were moved along their radius, to 0.15 ... 1 of it: steep faces, star-shaped about the origin.
RawMesh spiky_ball() {
  RawMesh mesh = test::icosphere(1);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> radius(0.15, 1);
  for (Vec3& v : mesh.vertices) v *= radius(random);
  return mesh;
}

LevelSetExpansion expansion_of(const RawMesh& mesh, const Vec3& origin, double time, int grid) {
  const auto backend = make_cpu_backend();
  Monitor monitor;
  ExpandSurfaceOptions options;
  options.lmax = 3;
  options.origin = origin;
  options.grid_degree = grid;
  return expand_level_set(mesh, time, options, *backend, monitor);
}

// The largest error over its uncertainty among the fields from `first` on.
double worst_part(const LevelSetExpansion& found, const LevelSetCoefficients& truth, std::size_t fields) {
  const double whole = std::sqrt(4 * std::numbers::pi);
  double worst = 0;
  for (int l = 0; l <= 3; ++l)
    for (int m = 0; m <= l; ++m)
      for (std::size_t f = 0; f < fields; ++f) {
        auto a = found.expansion.coefficients.at(int(f), l, m);
        if (l == 0 && f == 1) a += whole * found.expansion.mean_dtheta;
        if (l == 0 && f == 2) a += whole * found.expansion.mean_dphi;
        const double off = std::abs(a - truth[std::size_t(l * (l + 1) / 2 + m)][f]);
        worst = std::max(worst, off / found.uncertainty[std::size_t(l)][f]);
      }
  return worst;
}

struct Case {
  const char* what;
  RawMesh mesh;
  Vec3 origin;
  double time;
};

// Distances and sides that change from place to place without a pattern: nothing can be settled with them.
class Nonsense : public DistanceField {
public:
  MemoryNeed memory(std::uint64_t) const override { return {}; }
  void prepare() override {}
  ClosestPoints closest(std::span<const Vec3> queries, const ClosestOptions& options, Monitor&,
                        ClosestReport*) override {
    ClosestPoints points;
    for (const Vec3& q : queries) {
      const bool inside = q.norm() < 1 || std::sin(1e15 * q.sum()) > 0;
      points.distance.push_back(inside && options.with_sign ? -1 : 1);
      points.point.push_back(q + Vec3::UnitX());
      points.face.push_back(0);
      points.barycentric.push_back(Vec3::UnitX());
      points.feature.emplace_back();
      if (options.with_sign) points.winding.push_back(inside ? 1 : 0);
    }
    return points;
  }
};

// Distances that are right but in a cone about +z, where nothing can be settled.
class UnsureUp : public DistanceField {
public:
  explicit UnsureUp(std::unique_ptr<DistanceField> field) : field_(std::move(field)) {}
  MemoryNeed memory(std::uint64_t queries) const override { return field_->memory(queries); }
  void prepare() override { field_->prepare(); }
  ClosestPoints closest(std::span<const Vec3> queries, const ClosestOptions& options, Monitor& monitor,
                        ClosestReport* report) override {
    ClosestPoints points = field_->closest(queries, options, monitor, report);
    for (std::size_t i = 0; i < queries.size(); ++i)
      if (queries[i].z() > 0.95 * queries[i].norm() && queries[i].norm() > 0.2)
        points.distance[i] *= std::sin(1e15 * queries[i].sum()) > 0 ? 2 : 0.5;
    return points;
  }

private:
  std::unique_ptr<DistanceField> field_;
};

class UnsureBackend : public CpuWithAFault {
public:
  std::unique_ptr<DistanceField> distance_field(std::span<const Vec3> vertices,
                                                std::span<const Face> faces) const override {
    return std::make_unique<UnsureUp>(CpuWithAFault::distance_field(vertices, faces));
  }
};

} // namespace

namespace {

std::vector<Case> star_shaped_bodies() {
  const Vec3 zero = Vec3::Zero();
  const RawMesh brick = box({1, 2, 3}, {-0.5, -1, -1.5});
  return {
      {"box", brick, zero, 0},
      {"box off its middle", brick, {0.4, 0.9, -1.3}, 0},
      {"box, origin on a face's inner side", brick, {0.499, 0.2, 0.3}, 0},
      {"plate", box({1, 1, 0.01}, {-0.5, -0.5, -0.005}), zero, 0},
      {"needle", box({0.01, 0.01, 1}, {-0.005, -0.005, -0.5}), zero, 0},
      {"tetrahedron", builtin_mesh("tetrahedron"), {0.05, 0.1, 0.02}, 0},
      {"ellipsoid off its middle", builtin_mesh("ellipsoid:3,2,1@2"), {1.5, -0.7, 0.1}, 0},
      {"L", l_prism(), {0.5, 0.5, 0.5}, 0},
      {"L, barely star-shaped", l_prism(), {0.999, 0.5, 0.3}, 0},
      {"L, its inner edge at the origin", l_prism(), {0.9999999, 0.99999, 0.3}, 0},
      {"spikes", spiky_ball(), zero, 0},
      {"box at 0.01", brick, {0.1, 0.2, 0.3}, 0.01},
      {"box at 3", brick, {0.1, 0.2, 0.3}, 3},
      {"plate at 0.5", box({1, 1, 0.01}, {-0.5, -0.5, -0.005}), {0.2, 0.1, 0}, 0.5},
      {"tetrahedron at 0.5", builtin_mesh("tetrahedron"), zero, 0.5},
      {"needle at its own thickness", box({0.01, 0.01, 1}, {-0.005, -0.005, -0.5}), {0, 0, 0.3}, 0.01},
  };
}

void check_against_quadrature(std::span<const Case> cases) {
  for (const Case& c : cases) {
    CAPTURE(c.what);
    const LevelSetExpansion found = expansion_of(c.mesh, c.origin, c.time, 64);
    const LevelSetCoefficients truth = level_set_coefficients(c.mesh, c.origin, c.time, 3, 1e-7);
    CHECK(found.level_set.unsettled == 0);
    CHECK(found.failure.empty());
    CHECK(worst_part(found, truth, 6) <= 1);
    // An uncertainty that says nothing would hold everything.
    CHECK(found.uncertainty[0][0] < 0.02 * truth[0][0].real());
  }
}

} // namespace

TEST_CASE("a box, a thin plate and spikes expand over their level set to what quadrature over the surface gives",
          "[level_set]") {
  std::vector<Case> some;
  for (const Case& c : star_shaped_bodies())
    if (c.what == std::string("box") || c.what == std::string("plate") || c.what == std::string("spikes") ||
        c.what == std::string("box at 0.01"))
      some.push_back(c);
  REQUIRE(some.size() == 4);
  check_against_quadrature(some);
}

TEST_CASE(
    "star-shaped bodies expand over their level set to what quadrature over the surface gives, within the uncertainty",
    "[level_set][long]") {
  check_against_quadrature(star_shaped_bodies());
}

TEST_CASE("a body that is star-shaped as it is expands to its radial function, and is rebuilt with its volume",
          "[level_set]") {
  const LevelSetExpansion found = expansion_of(box({1, 2, 3}, {-0.5, -1, -1.5}), Vec3::Zero(), 0, 128);
  CHECK(found.star.lower == 0);
  CHECK(found.time < 1e-8);
  CHECK(found.expansion.coefficients.at(0, 0, 0).real() / std::sqrt(4 * std::numbers::pi) ==
        Approx(1.00210).margin(1.2e-4));
  const TemporaryFolder folder;
  REQUIRE(run_program({"expand", "builtin:box:1,2,3", "--of", "flow", "--flow-grid", "128", "--lmax", "64", "--device",
                       "cpu", "-q", "-o", folder / "box.json"})
              .exit_code == 0);
  const ProgramRun run =
      run_program({"reconstruct", folder / "box.json", "--order", "64", "--device", "cpu", "--json"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  CHECK(nlohmann::json::parse(run.out)["orders"][0]["volume"].get<double>() == Approx(6).epsilon(2e-3));
}

TEST_CASE("a level set is met from inside only, and an origin outside of it is refused", "[level_set]") {
  const ProgramRun run = run_program(
      {"expand", "builtin:box:1,2,3", "--of", "flow", "--time", "0.5", "--origin", "1.5,0,0", "--device", "cpu"});
  CHECK(run.exit_code == 2);
  CHECK(run.out.empty());
  CHECK_THAT(run.err, Contains("lies 1 from the body") && Contains("--time auto"));
}

TEST_CASE("directions that do not settle are counted with their solid angle", "[level_set]") {
  Nonsense field;
  Monitor monitor;
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 8);
  LevelSetReport report;
  (void)level_set_positions({field, {{-1, -1, -1}, {1, 1, 1}}, Vec3::Zero(), 0.5}, grid, monitor, &report);
  CHECK(report.unsettled == grid.points());
  CHECK(report.unsettled_angle == Approx(4 * std::numbers::pi));
}

TEST_CASE("directions that do not settle enter the uncertainty, and beyond it are a failure", "[level_set]") {
  UnsureBackend backend;
  Monitor monitor;
  ExpandSurfaceOptions options;
  options.lmax = 2;
  options.grid_degree = 64;
  const LevelSetExpansion found = expand_level_set(box({1, 1, 1}, {-0.5, -0.5, -0.5}), 0.3, options, backend, monitor);
  const double cone = 2 * std::numbers::pi * 0.05;
  CHECK(found.level_set.unsettled > 0);
  // Some directions end on a place that looks settled by chance.
  CHECK((found.level_set.unsettled_angle > 0.75 * cone && found.level_set.unsettled_angle < 1.05 * cone));
  CHECK(found.uncertainty[0][0] > found.level_set.unsettled_angle * 0.5 / std::sqrt(4 * std::numbers::pi));
  CHECK_THAT(found.failure, Contains("did not settle on the level set") && Contains("--time"));
}

TEST_CASE("what is thinner than a cell of the grid is known to its uncertainty", "[level_set]") {
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized().toRotationMatrix();
  const auto turned = [&](RawMesh mesh) {
    for (Vec3& v : mesh.vertices) v = turn * v;
    return mesh;
  };
  const auto plate = [](double thickness) { return box({1, 2, thickness}, {-0.5, -1, -thickness / 2}); };
  const Vec3 zero = Vec3::Zero();
  const std::vector<Case> cases = {
      {"plate of 0.01", plate(0.01), zero, 0},
      {"plate of 0.01, origin off its middle",
       plate(0.01),
       {0.34622219140704946, -0.03875513288549837, 0.0023885604},
       0},
      {"plate of 0.003", plate(0.003), zero, 0},
      {"plate of 0.0001", plate(1e-4), zero, 0},
      {"plate of 0.00001", plate(1e-5), zero, 0},
      {"plate of 0.003, turned", turned(plate(0.003)), zero, 0},
      {"plate of 0.0001, turned", turned(plate(1e-4)), zero, 0},
      {"needle of 0.001", box({0.001, 0.0013, 1}, {-0.0005, -0.00065, -0.5}), zero, 0},
      {"needle along x", box({1, 0.01, 0.02}, {-0.5, -0.005, -0.01}), {0.2, 0.001, -0.003}, 0},
      {"needle of 0.003, turned", turned(box({0.003, 0.003, 1}, {-0.0015, -0.0015, -0.5})), zero, 0},
      {"plate of 0.001 at 0.01", box({1, 1, 0.001}, {-0.5, -0.5, -0.0005}), {0.2, 0.1, 0}, 0.01},
  };
  for (const Case& c : cases)
    for (const int grid : {64, 128}) {
      CAPTURE(c.what, grid);
      const LevelSetExpansion found = expansion_of(c.mesh, c.origin, c.time, grid);
      const LevelSetCoefficients truth = level_set_coefficients(c.mesh, c.origin, c.time, 3, 1e-7);
      CHECK(worst_part(found, truth, 6) <= 1);
      CHECK(found.uncertainty[0][0] < 4e-3);
      CHECK(found.sutures.jumps.pairs == 0); // steep, but without a jump
    }
}
