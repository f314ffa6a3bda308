#include "host/error.hpp"
#include "host/mesh/builtin.hpp"
#include "host/physics/surface_gravity.hpp"
#include "host/requests/surface_gravity.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;

namespace {

constexpr double pi = std::numbers::pi;

SurfaceGravityRequest request_of(const std::string& mesh, ValuePlace place = ValuePlace::faces) {
  SurfaceGravityRequest request;
  request.body.mesh = mesh;
  request.place = place;
  return request;
}

SurfaceGravityResult answer(const SurfaceGravityRequest& request) {
  Monitor silent;
  static const std::unique_ptr<Backend> backend = make_cpu_backend(2);
  return surface_gravity(plan_surface_gravity(request, silent), *backend, silent);
}

const std::vector<double>& column(const SurfaceGravityResult& result, const std::string& name, int components = 1) {
  for (const ValueColumn& c : result.values.columns)
    if (c.name == name && c.components == components) return c.values;
  throw std::runtime_error("there is no column " + name);
}

Vec3 vector_at(const std::vector<double>& flat, std::size_t i) {
  return {flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]};
}

double greatest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}
double least(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

void refused(const SurfaceGravityRequest& request, const char* words) {
  Monitor silent;
  CHECK_THROWS_WITH(plan_surface_gravity(request, silent), Contains(words));
}

// omega^2/(pi G rho) of the oblate spheroid of this eccentricity that is level (C. Maclaurin; S. Chandrasekhar, Ellipsoidal Figures of
// Equilibrium, 1969, sect. 32, eq. 4).
double maclaurin_square(double e) {
  return 2 * std::sqrt(1 - e * e) / (e * e * e) * (3 - 2 * e * e) * std::asin(e) - 6 / (e * e) * (1 - e * e);
}

} // namespace

TEST_CASE("gravity in the middles of a cube's faces is its sheets' solid angles, and potentials are in closed form",
          "[surface-gravity]") {
  // A square sheet of half side 1/2 is seen from z above its middle under the solid angle 4 asin(1/(1 + 4 z^2)), which is its pull.
  long double pull = 0;
  constexpr int steps = 4000;
  for (int i = 0; i <= steps; ++i) {
    const long double z = (long double)(i) / steps, weight = i == 0 || i == steps ? 1 : i % 2 ? 4 : 2;
    pull += weight * 4 * std::asin(1 / (1 + 4 * z * z)) / (3 * steps);
  }
  SurfaceGravityRequest request = request_of("builtin:box:1,1,1");
  request.place = ValuePlace::points;
  request.points = {{0.5, 0, 0}, {0, -0.5, 0}, {0, 0, 0}, {0.5, 0.5, 0.5}};
  request.tolerance = 0;
  const SurfaceGravityResult result = answer(request);
  const auto& g = column(result, "g", 3);
  const auto& potential = column(result, "potential");
  CHECK((vector_at(g, 0) + double(pull) * Vec3::UnitX()).norm() <= 1e-13);
  CHECK((vector_at(g, 1) - double(pull) * Vec3::UnitY()).norm() <= 1e-13);
  CHECK(vector_at(g, 2).norm() <= 2e-15);
  const double middle = 3 * std::log(2 + std::sqrt(3.0)) - pi / 2;
  CHECK(potential[2] == Approx(-middle).epsilon(4e-15));
  CHECK(potential[3] == Approx(-middle / 2).epsilon(4e-15));
  CHECK(column(result, "escape_speed")[2] == Approx(std::sqrt(2 * middle)).epsilon(1e-14));
  CHECK(result.areas.empty());
  CHECK_THAT(result.places, Contains("4 points"));
}

TEST_CASE("slopes of a ball of facets that does not spin are its facets' tilts, and its elevations their sagittas",
          "[surface-gravity]") {
  double before = 0;
  for (const int level : {2, 3}) {
    const SurfaceGravityResult faces = answer(request_of("builtin:sphere:2@" + std::to_string(level)));
    const auto &slope = column(faces, "slope"), &tilt = column(faces, "tilt"), &size = column(faces, "g");
    double off = 0;
    for (std::size_t i = 0; i < slope.size(); ++i) off = std::max(off, std::abs(slope[i] - tilt[i]));
    const double h = greatest(tilt);
    INFO("level " << level << ": tilts to " << h << ", slopes off by " << off);
    CHECK(h > 0.1);
    CHECK(off <= 0.15 * h); // the pull of unlike neighbours turns it by a part of that
    // g of a ball of radius 2 and density 1 with its surface cut off: 8 pi/3 to the order of the facets.
    const double g_off = std::max(greatest(size) / (8 * pi / 3) - 1, 1 - least(size) / (8 * pi / 3));
    CHECK(g_off <= (level == 2 ? 0.012 : 0.003));
    const double range = greatest(column(faces, "elevation")) - least(column(faces, "elevation"));
    check_at_most(range, level == 2 ? 8e-3 : 2.4e-3, "elevations of faces");
    if (before > 0) CHECK(before / range > 3);
    before = range;
  }
  const SurfaceGravityResult vertices = answer(request_of("builtin:sphere:2@3", ValuePlace::vertices));
  CHECK(greatest(column(vertices, "slope")) <= 0.3); // degrees
  CHECK(vertices.values.places.size() == 642);
}

TEST_CASE("an ellipsoid that spins at its Maclaurin rate is level to the order of its facets", "[surface-gravity]") {
  const double e = 0.8, c = std::sqrt(1 - e * e);
  double before_range = 0, before_slope = 0;
  for (const int level : {2, 3}) {
    SurfaceGravityRequest request =
        request_of("builtin:ellipsoid:1,1," + std::to_string(c) + "@" + std::to_string(level), ValuePlace::vertices);
    const SurfaceGravityResult still = answer(request);
    request.spin_rate = Measure{std::sqrt(pi * maclaurin_square(e)), false, {}};
    const SurfaceGravityResult result = answer(request);
    REQUIRE(result.spin);
    CHECK(std::abs(result.spin->axis.z()) == Approx(1).epsilon(1e-12));
    const double range = greatest(column(result, "elevation")) - least(column(result, "elevation"));
    const double slope = greatest(column(result, "slope"));
    INFO("level " << level << ": elevations over " << range << ", slopes to " << slope);
    // Without the spin water runs to the poles, over a fifth of the radius and more.
    CHECK(greatest(column(still, "elevation")) - least(column(still, "elevation")) > 0.1);
    CHECK(greatest(column(still, "slope")) > 11);
    CHECK(range <= (level == 2 ? 7e-4 : 2.2e-4));
    CHECK(slope <= (level == 2 ? 1.7 : 0.65)); // degrees
    if (before_range > 0) {
      CHECK(before_range / range > 3);
      CHECK(before_slope / slope > 2.5);
    }
    before_range = range;
    before_slope = slope;
  }
}

TEST_CASE("half the speed of turning is in g and the geopotential as the centrifugal law has it", "[surface-gravity]") {
  SurfaceGravityRequest request = request_of("builtin:box:1,2,3", ValuePlace::vertices);
  request.tolerance = 0;
  const SurfaceGravityResult still = answer(request);
  request.spin_rate = Measure{0.5, false, {}};
  request.spin_axis = Vec3(0, 0.6, 0.8);
  request.body.origin = {"given", Vec3(0.1, 0.2, 0.3)};
  const SurfaceGravityResult spun = answer(request);
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 omega = 0.5 * *request.spin_axis, r = still.values.places[i] - Vec3(0.1, 0.2, 0.3);
    const Vec3 centrifugal = -omega.cross(omega.cross(r));
    CHECK((vector_at(column(spun, "g", 3), i) - vector_at(column(still, "g", 3), i) - centrifugal).norm() <= 1e-14);
    CHECK(column(spun, "geopotential")[i] ==
          Approx(column(still, "potential")[i] - omega.cross(r).squaredNorm() / 2).epsilon(1e-14));
    CHECK(column(spun, "potential")[i] == column(still, "potential")[i]);
    CHECK(column(spun, "g")[i] == Approx(vector_at(column(spun, "g", 3), i).norm()).epsilon(1e-15));
  }
  CHECK(spun.spin->through == Vec3(0.1, 0.2, 0.3));
}

TEST_CASE("two bodies pull with both masses, and inside a hollow ball nothing does", "[surface-gravity]") {
  const TemporaryFolder folder;
  const std::string two = folder / "two.off", hollow = folder / "hollow.off";
  const RawMesh ball = icosphere(3);
  std::ofstream(two) << off_text(together(ball, translated(ball, Vec3(5, 0, 0))));
  std::ofstream(hollow) << off_text(together(scaled(ball, Vec3::Constant(2)), flipped(ball)));
  SurfaceGravityRequest request = request_of(two, ValuePlace::points);
  request.points = {{2.5, 0, 0}, {2.5, 100, 0}};
  const SurfaceGravityResult pair = answer(request);
  CHECK(vector_at(column(pair, "g", 3), 0).norm() <= 1e-12 * pair.gravity_scale + 1e-12);
  CHECK(column(pair, "potential")[0] == Approx(-pair.mass / 2.5).epsilon(2e-5)); // the facets' degree 6
  request.body.mesh = hollow;
  request.points = {{0.1, 0.2, 0.3}, {0, 0, 1.5}};
  const SurfaceGravityResult shell = answer(request);
  check_at_most(vector_at(column(shell, "g", 3), 0).norm(), 3e-3,
                "g in a cavity"); // of 4.2 at the surface of a ball of radius 1
  // By a part of negative density the same.
  const std::string outer = folder / "outer.off", inner = folder / "inner.off";
  std::ofstream(outer) << off_text(scaled(ball, Vec3::Constant(2)));
  std::ofstream(inner) << off_text(ball);
  request.body.mesh = outer;
  request.body.parts = {{inner, -1}};
  const SurfaceGravityResult part = answer(request);
  for (std::size_t i = 0; i < 2; ++i)
    CHECK((vector_at(column(part, "g", 3), i) - vector_at(column(shell, "g", 3), i)).norm() <=
          4e-9 * shell.gravity_scale);
}

TEST_CASE("places stand above faces and vertices along their normals", "[surface-gravity]") {
  SurfaceGravityRequest request = request_of("builtin:sphere@3", ValuePlace::vertices);
  request.height = Measure{2, false, {}};
  const SurfaceGravityResult high = answer(request);
  for (const Vec3& p : high.values.places) CHECK(p.norm() == Approx(3).epsilon(1e-3));
  CHECK(column(high, "g")[5] == Approx(high.mass / 9).epsilon(1e-3));
  request.place = ValuePlace::faces;
  CHECK(answer(request).values.places.size() == 1280);
  CHECK_THAT(answer(request).values.notes.back(), Contains("2 lengths of the mesh along"));
}

TEST_CASE("what cannot be meant is refused in words before anything is summed", "[surface-gravity]") {
  SurfaceGravityRequest request = request_of("builtin:sphere@2");
  request.spin_rate = Measure{0.1, false, {}};
  refused(request, "three equal moments of inertia, as a ball has");
  request.spin_axis = Vec3(0, 0, 2);
  refused(request, "the axis of --spin");
  request.spin_axis = Vec3::UnitZ();
  CHECK(answer(request).spin->axis == Vec3::UnitZ());
  request.spin_rate->has_unit = true;
  refused(request, "needs the mesh's unit of length");
  request.body.length = 500;
  request.spin_rate->has_unit = false;
  refused(request, "it needs a unit");
  request = request_of("builtin:ellipsoid:2,1,1@2"); // a cigar
  request.spin_rate = Measure{0.1, false, {}};
  refused(request, "none of its axes has the largest one");
  request.spin_rate.reset();
  request.spin_axis = Vec3::UnitX();
  refused(request, "not how fast");
  request.spin_axis.reset();
  request.spin_rate = Measure{0, false, {}};
  refused(request, "from 1e-50 to 1e50");
  request.spin_rate->value = 1e200;
  refused(request, "from 1e-50 to 1e50");
  request.spin_rate.reset();
  request.tolerance = 1e-13;
  refused(request, "it is from 1e-12 to 0.01");
  request.tolerance = 0;
  request.guarantee = true;
  refused(request, "leaves nothing out");
  request = request_of("builtin:sphere@2");
  request.mass = Measure{1e12, true, "kg"};
  refused(request, "needs the mesh's unit of length");
  request.body.density = 2;
  refused(request, "both say how heavy");
  request.body.density.reset();
  request.mass->value = -1;
  refused(request, "must be above 0");
  request = request_of("builtin:sphere@2", ValuePlace::points);
  refused(request, "no point");
  request.points = {Vec3(0, 0, 1e300)};
  Monitor silent;
  const auto backend = make_cpu_backend(1);
  CHECK_THROWS_WITH(surface_gravity(plan_surface_gravity(request, silent), *backend, silent),
                    Contains("farther than 1e150 radii"));
  request.height = Measure{1, false, {}};
  refused(request, "points stand where they are");
}

TEST_CASE("a mass makes the density, with units and without", "[surface-gravity]") {
  SurfaceGravityRequest request = request_of("builtin:box:1,2,3");
  request.mass = Measure{12, false, {}};
  CHECK(answer(request).density == Approx(2).epsilon(1e-15));
  request.body.length_unit = 1000;
  request.mass = Measure{6e12, true, "kg"};
  const SurfaceGravityResult result = answer(request);
  CHECK(result.density == Approx(1000).epsilon(1e-14));
  CHECK(result.mass == Approx(6e12).epsilon(1e-15));
  CHECK(result.values.length_unit == "m");
  CHECK_THAT(findings(result).notes.empty() ? "" : findings(result).notes[0], !Contains("1 kg/m3"));
}
