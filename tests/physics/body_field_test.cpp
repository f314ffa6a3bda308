// The one interface to a body's exact field: a device's sums against those in 80-bit arithmetic, and both against what they state.
#include "host/error.hpp"
#include "host/mesh/builtin.hpp"
#include "host/physics/body_field.hpp"
#include "host/physics/polyhedron.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using physics::BodyField;
using physics::BodyFieldProblem;
using physics::BodyFieldValues;
using physics::FieldSum;

namespace {

constexpr double pi = std::numbers::pi;

Body body_of(RawMesh mesh, double density = 1, std::vector<Part> parts = {}) {
  return make_body(ClosedSurface::from(std::move(mesh)), {}, density, std::move(parts));
}

const Backend& cpu() {
  static const std::unique_ptr<Backend> backend = make_cpu_backend(2);
  return *backend;
}

BodyFieldValues field_of(const Body& body, const std::vector<Vec3>& points, const BodyFieldProblem& problem) {
  Monitor silent;
  return BodyField(body, problem, cpu()).at(points, silent);
}

// Corners, middles of edges and faces, places inside, beside and far away.
std::vector<Vec3> places_about(const Body& body, std::size_t count) {
  std::vector<Vec3> points;
  const auto& vertices = body.surface.vertices();
  const auto& faces = body.surface.faces();
  const std::size_t stride = std::max<std::size_t>(1, faces.size() / count);
  for (std::size_t f = 0; f < faces.size(); f += stride) {
    const Vec3 &a = vertices[faces[f][0]], &b = vertices[faces[f][1]], &c = vertices[faces[f][2]];
    points.insert(points.end(), {(a + b + c) / 3, a, (a + b) / 2, 0.9 * (a + b + c) / 3 + 0.1 * body.box.middle()});
  }
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const double reach : {1.0, 2.0, 5.0, 30.0, 1e3, 1e6, 1e40})
    for (int i = 0; i < 4; ++i)
      points.push_back(body.box.middle() + reach * body.brillouin_radius *
                                               Vec3(normal(random), normal(random), normal(random)).normalized());
  return points;
}

struct Bodies {
  const char* name;
  Body body;
};

std::vector<Bodies> bodies() {
  std::vector<Bodies> all;
  all.push_back({"box", body_of(box(Vec3(1, 2, 3)), 2.5)});
  all.push_back({"ball", body_of(icosphere(3))});
  all.push_back({"cow", body_of(builtin_mesh("cow@1"))});
  all.push_back({"torus", body_of(torus(24, 12))});
  all.push_back({"needle", body_of(scaled(icosphere(2), Vec3(1, 1e-3, 1e-3)))});
  all.push_back({"cavity", body_of(shell_with_cavity(), 3)});
  all.push_back({"two shells", body_of(two_shells())});
  all.push_back({"parts", body_of(box(Vec3(2, 2, 2)), 3,
                                  {Part(ClosedSurface::from(box(Vec3(0.5, 0.5, 0.5), Vec3(1, 1, 1))), -3),
                                   Part(ClosedSurface::from(translated(icosphere(2), Vec3(4, 0, 0))), 7)})});
  all.push_back({"hollow", body_of(box(Vec3(2, 2, 2)), 3,
                                   {Part(ClosedSurface::from(box(Vec3::Constant(1.99), Vec3::Constant(0.005))), -3)})});
  return all;
}

} // namespace

TEST_CASE("a device's sums are right to what they state, at corners, edges, faces and far away", "[body-field]") {
  double worst = 0;
  for (const Bodies& one : bodies()) {
    const Body& body = one.body;
    const std::vector<Vec3> points = places_about(body, 30);
    const BodyFieldValues truth = field_of(body, points, {Derivatives::first, FieldSum::extended});
    for (const double tolerance : {0.0, 1e-9, 1e-3}) {
      INFO(one.name << " to " << tolerance);
      BodyFieldProblem problem{Derivatives::first, FieldSum::device, 0, tolerance};
      const BodyFieldValues found = field_of(body, points, problem);
      double value = 0, gradient = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 off = found.field.gradient[i] - truth.field.gradient[i];
        const double d = (points[i] - body.box.middle()).stableNorm();
        value = std::max(value, std::abs(found.field.value[i] - truth.field.value[i]));
        gradient = std::max(gradient, off.stableNorm());
        // The relative error that is stated holds at each place.
        const double scale = std::max(truth.field.gradient[i].stableNorm(), std::abs(truth.field.value[i]) / d);
        INFO("place " << i << " at " << d);
        CHECK(off.stableNorm() <= (found.error + truth.error) * scale);
        CHECK(std::abs(found.field.value[i] - truth.field.value[i]) <=
              (found.error + truth.error) * std::abs(truth.field.value[i]));
        CHECK(std::abs(found.density[i] - truth.density[i]) <= std::max(1e-9, tolerance) * std::abs(body.density));
      }
      CHECK(value <= found.value_error + truth.value_error);
      CHECK(gradient <= found.gradient_error + truth.gradient_error);
      CHECK(found.gradient_error <= 1.01 * (tolerance * physics::gravity_scale(body)) + 1e-11);
      if (tolerance == 0) worst = std::max(worst, gradient / found.gradient_error);
    }
  }
  check_at_most(worst, 0.8, "largest error of sums over all faces, in what is stated");
}

TEST_CASE("the series is taken where sums in double precision lose digits: far from a hollow body, beside a thin one",
          "[body-field]") {
  const std::vector<Vec3> points = {{0.5, 1, 4}, {0, 0, 60}, {0, 3e4, 4e4}, {1e100, 0, 0}};
  const Body solid = body_of(box(Vec3(1, 2, 3)), 2), thin = body_of(box(Vec3(1, 1, 1e-9))),
             hollow = body_of(box(Vec3(2, 2, 2)), 3,
                              {Part(ClosedSurface::from(box(Vec3::Constant(1.999), Vec3::Constant(0.0005))), -3)});
  for (const Body* body : {&solid, &thin, &hollow}) {
    const BodyFieldValues found = field_of(*body, points, {Derivatives::second, FieldSum::device}),
                          exact = field_of(*body, points, {Derivatives::second, FieldSum::extended});
    const std::uint8_t far = body == &solid ? 0 : 1;
    CHECK(found.by_series[2] == far);
    CHECK(found.by_series[3] == far);
    CHECK(found.density[2] == 0);
    CHECK(found.field.value[3] == Approx(body->mass() * 1e-100).epsilon(1e-13));
    for (std::size_t i = 0; i < points.size(); ++i)
      CHECK((found.field.gradient[i] - exact.field.gradient[i]).stableNorm() <=
            (found.error + exact.error) * exact.field.gradient[i].stableNorm());
    if (body == &solid) CHECK(found.error <= 2e-12);
    // What may be lost anyway needs no series.
    if (body != &thin)
      CHECK(field_of(*body, points, {Derivatives::first, FieldSum::device, 0, 1e-2}).by_series[1] == 0);
  }
}

TEST_CASE("second derivatives of a device's sums are those of 80-bit arithmetic, and are refused on edges",
          "[body-field]") {
  const Body body = body_of(builtin_mesh("cow@0"), 2, {Part(ClosedSurface::from(icosphere(1)), -1)});
  std::vector<Vec3> points;
  for (const Face& f : body.surface.faces()) {
    const auto& v = body.surface.vertices();
    points.emplace_back((v[f[0]] + v[f[1]] + v[f[2]]) / 3);
  }
  const BodyFieldValues found = field_of(body, points, {Derivatives::second, FieldSum::device}),
                        truth = field_of(body, points, {Derivatives::second, FieldSum::extended});
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SymmetricTensor& h = found.field.hessian[i];
    CHECK(std::abs(h[0] + h[3] + h[5] + 4 * pi * found.density[i]) <= 1e-11);
    for (std::size_t c = 0; c < 6; ++c) worst = std::max(worst, std::abs(h[c] - truth.field.hessian[i][c]));
  }
  check_at_most(worst, 4e-12, "second derivatives");
  points = {body.surface.vertices()[0]};
  CHECK_THROWS_WITH(field_of(body, points, {Derivatives::second, FieldSum::device}), Contains("lies on an edge"));
  CHECK_NOTHROW(field_of(body, points, {Derivatives::first, FieldSum::device}));
}

TEST_CASE("a tolerance counts for the whole body, and its guarantee gives each place a bound", "[body-field]") {
  for (const Bodies& one : bodies()) {
    const Body& body = one.body;
    const std::vector<Vec3> points = places_about(body, 20);
    BodyFieldProblem problem{Derivatives::first, FieldSum::device, 0, 1e-6, true};
    const BodyFieldValues found = field_of(body, points, problem),
                          truth = field_of(body, points, {Derivatives::first, FieldSum::extended});
    REQUIRE(found.bound.size() == points.size());
    const double allowed = 1e-6 * physics::gravity_scale(body);
    BodyFieldProblem all = problem;
    all.tolerance = 0;
    all.guarantee = false;
    const double rounding = field_of(body, points, all).gradient_error;
    INFO(one.name);
    for (std::size_t i = 0; i < points.size(); ++i) {
      CHECK(found.bound[i] <= allowed * (1 + 1e-9));
      CHECK((found.field.gradient[i] - truth.field.gradient[i]).norm() <= found.bound[i] + rounding);
    }
  }
}

TEST_CASE("what a body's field needs is known before, and nonsense is refused in words", "[body-field]") {
  const Body body = body_of(box(Vec3::Ones()), 1, {Part(ClosedSurface::from(box(Vec3::Ones())), 1)});
  for (const FieldSum sum : {FieldSum::extended, FieldSum::device}) {
    const BodyField field(body, {Derivatives::first, sum}, cpu());
    CHECK(field.memory(1000000).host > field.memory(1).host + 1000000 * 8 * 6);
    Monitor silent;
    const std::vector<Vec3> points = {{0, 0, 0}, {1, std::nan(""), 0}};
    CHECK_THROWS_WITH(field.at(points, silent), Contains("not finite"));
    CHECK(field.at({}, silent).field.value.empty());
  }
  for (const double tolerance : {-1.0, 1e-13, 0.5, std::nan("")})
    CHECK_THROWS_WITH(BodyField(body, {Derivatives::first, FieldSum::device, 0, tolerance}, cpu()),
                      Contains("must be 0") && Contains("GM/R^2"));
}
