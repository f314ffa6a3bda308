#include "host/error.hpp"
#include "host/mass/mass_moments.hpp"
#include "host/physics/body_field.hpp"
#include "host/physics/polyhedron.hpp"
#include "host/physics/potential.hpp"
#include "host/reference/potential.hpp"
#include "tests/support/compare_potential.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;
using physics::LongMatrix3;
using physics::LongVec3;
using physics::Polyhedron;
using physics::PolyhedronAt;

namespace {

using Real = long double;
constexpr Real pi = std::numbers::pi_v<Real>;

Polyhedron polyhedron(const RawMesh& mesh) {
  return Polyhedron(mesh.vertices, mesh.faces);
}

// A box by the signed sum over its corners of the potential of the box between the point and the corner (W. D. MacMillan, The
// Theory of the Potential, 1930, sect. 40); on faces second derivatives are the mean of both sides'.
struct BoxField {
  Real value = 0;
  LongVec3 gradient = LongVec3::Zero();
  LongMatrix3 hessian = LongMatrix3::Zero();
};

Real logarithm(Real z, Real x, Real y) {
  return z == 0 ? 0 : std::asinh(z / std::hypot(x, y));
}
Real times(Real factor, Real value) {
  return factor == 0 ? 0 : factor * value;
}

BoxField box_field(const LongVec3& low, const LongVec3& high, const LongVec3& at) {
  BoxField sum;
  for (int corner = 0; corner < 8; ++corner) {
    LongVec3 x;
    for (int c = 0; c < 3; ++c) x[c] = (corner >> c & 1 ? high : low)[c] - at[c];
    const int highs = (corner & 1) + (corner >> 1 & 1) + (corner >> 2 & 1);
    const Real sign = highs % 2 ? 1 : -1;
    const Real d = x.norm();
    LongVec3 angle, log; // log[c] goes with the axis c
    for (int c = 0; c < 3; ++c) {
      const Real y = x[(c + 1) % 3], z = x[(c + 2) % 3];
      angle[c] = x[c] == 0 ? 0 : std::atan(y * z / (x[c] * d));
      log[c] = y == 0 && z == 0 ? 0 : logarithm(x[c], y, z);
    }
    for (int c = 0; c < 3; ++c) {
      const int u = (c + 1) % 3, v = (c + 2) % 3;
      sum.value += sign * (times(x[u] * x[v], log[c]) - x[c] * x[c] * angle[c] / 2);
      sum.gradient[c] -= sign * (times(x[u], log[v]) + times(x[v], log[u]) - x[c] * angle[c]);
      sum.hessian(c, c) -= sign * angle[c];
      sum.hessian(u, v) += sign * log[c];
      sum.hessian(v, u) += sign * log[c];
    }
  }
  return sum;
}

Body body_of(RawMesh mesh, double density = 1, std::vector<Part> parts = {}) {
  return make_body(ClosedSurface::from(std::move(mesh)), {}, density, std::move(parts));
}

double worst(const Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>& a) {
  return double(a.cwiseAbs().maxCoeff());
}

} // namespace

TEST_CASE("the polyhedron's field is that of a box in closed form, inside, outside, on faces, edges and corners",
          "[polyhedron]") {
  const Vec3 sides(1, 2, 3), corner(-0.25, -1.5, -0.5);
  const LongVec3 low = corner.cast<Real>(), high = (corner + sides).cast<Real>();
  const Polyhedron box_body = polyhedron(box(sides, corner));
  const std::vector<Vec3> clear = {{0.1, 0.2, 0.3}, {0.7, -1.4, 2.2}, {2, 0.1, 1},
                                   {-1, -3, -2},    {5, 6, -7},       {0.75001, 0, 0}};
  const std::vector<Vec3> on_faces = {{0.75, 0.125, 0.25}, {0.1, 0.5, 0.5}, {0, 0, -0.5}};
  const std::vector<Vec3> on_edges = {
      {0.75, 0.5, 1}, {-0.25, -1.5, 0.5}, {0.1, 0.5, 2.5}, {0.75, 0.5, 2.5}, {-0.25, -1.5, -0.5}};
  for (const auto* points : {&clear, &on_faces, &on_edges})
    for (const Vec3& at : *points) {
      INFO("at " << at.transpose());
      const BoxField truth = box_field(low, high, at.cast<Real>());
      const PolyhedronAt found = box_body.at(at);
      check_at_most(double(std::fabs(found.value - truth.value)), 1e-16, "value");
      check_at_most(worst(found.gradient - truth.gradient), 1e-16, "gradient");
      CHECK(found.on_edge == (points == &on_edges));
      if (points == &on_edges) continue;
      check_at_most(worst(found.hessian - truth.hessian), 1e-16, "hessian");
      const Real winding = points == &on_faces                                                              ? 0.5L
                           : ((at - corner).array() > 0).all() && ((at - corner - sides).array() < 0).all() ? 1
                                                                                                            : 0;
      check_at_most(double(std::fabs(found.winding - winding)), 1e-17, "winding");
      check_at_most(double(std::fabs(found.hessian.trace() + 4 * pi * winding)), 1e-16, "trace");
    }
}

TEST_CASE("the potential of the unit cube is 3 ln(2 + sqrt 3) - pi/2 in its middle and half of that at a corner",
          "[polyhedron]") {
  const Polyhedron cube = polyhedron(box(Vec3::Ones()));
  const Real middle = 3 * std::log(2 + std::sqrt(3.0L)) - pi / 2;
  CHECK(std::fabs(cube.at(Vec3(0.5, 0.5, 0.5)).value - middle) <= 1e-18L);
  CHECK(std::fabs(cube.at(Vec3(1, 0, 1)).value - middle / 2) <= 1e-18L);
}

TEST_CASE("next to an edge nothing cancels", "[polyhedron]") {
  const Polyhedron cube = polyhedron(box(Vec3::Ones()));
  for (const double h : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const Vec3 at(1 + h, 1 + h, 0.5);
    const BoxField truth = box_field(LongVec3::Zero(), LongVec3::Ones(), at.cast<Real>());
    const PolyhedronAt found = cube.at(at);
    INFO("by " << h);
    check_at_most(worst(found.gradient - truth.gradient), 1e-17, "gradient");
    check_at_most(worst(found.hessian - truth.hessian), 1e-17 * std::abs(std::log(h)) + 1e-15 / h * 1e-5, "hessian");
  }
}

TEST_CASE("a fine ball attracts like its mass outside, and as a ball does inside", "[polyhedron]") {
  const RawMesh mesh = icosphere(4);
  const double volume = body_of(mesh).volume;
  const Polyhedron ball = polyhedron(mesh);
  const PolyhedronAt outside = ball.at(Vec3(0, 3, 4));
  CHECK(std::fabs(outside.value * 5 / volume - 1) <= 1e-7L);
  CHECK((outside.gradient * 25 / volume + LongVec3(0, 0.6L, 0.8L)).norm() <= 1e-7L);
  CHECK(std::fabs(outside.winding) <= 1e-16L);
  const PolyhedronAt inside = ball.at(Vec3(0.3, 0, 0.4));
  CHECK(std::fabs(inside.value / (2 * pi * (1 - 0.25L / 3)) - 1) <= 5e-3L); // the mesh's sagitta
  CHECK(std::fabs(inside.winding - 1) <= 1e-15L);
}

TEST_CASE("finer and finer ellipsoids have the potential of one in their middle", "[polyhedron]") {
  // Oblate: 2 pi a^2 c arccos(c/a) / sqrt(a^2 - c^2); the meshes' error falls fourfold, and is taken out.
  constexpr double a = 1.5, c = 0.5;
  const auto middle = [&](int level) {
    return polyhedron(scaled(icosphere(level), Vec3(a, a, c))).at(Vec3::Zero()).value;
  };
  const Real truth = 2 * pi * a * a * c * std::acos(Real(c) / a) / std::sqrt(Real(a * a - c * c));
  const Real coarse = middle(3), fine = middle(4);
  check_at_most(double(std::fabs((4 * fine - coarse) / 3 / truth - 1)), 4e-5, "ellipsoid");
}

TEST_CASE("cavities, shells one in the other and faces without area are what they are", "[polyhedron]") {
  const Polyhedron hollow = polyhedron(shell_with_cavity());
  CHECK(std::fabs(hollow.at(Vec3(0.1, 0.05, 0.02)).winding - std::round(hollow.at(Vec3(0.1, 0.05, 0.02)).winding)) <=
        1e-17L);
  // An edge split by a vertex, closed with a face without area.
  RawMesh split = box(Vec3::Ones());
  const Vec3 at(0.3, 0.4, 1.7);
  const PolyhedronAt whole = polyhedron(split).at(at);
  const Face f = split.faces[0];
  split.vertices.push_back((split.vertices[f[0]] + split.vertices[f[1]]) / 2);
  const auto v = std::uint32_t(split.vertices.size() - 1);
  split.faces[0] = {v, f[1], f[2]};
  split.faces.push_back({f[0], v, f[2]});
  split.faces.push_back({f[1], v, f[0]});
  const PolyhedronAt parts = polyhedron(split).at(at);
  check_at_most(double(std::fabs(parts.value - whole.value)), 1e-18, "value");
  check_at_most(worst(parts.hessian - whole.hessian), 1e-17, "hessian");
}

TEST_CASE("a body's parts add with their densities", "[polyhedron]") {
  const RawMesh outer = box(Vec3(2, 2, 2)), inner = box(Vec3(0.5, 0.5, 0.5), Vec3(1, 1, 1));
  const Body body = body_of(outer, 3, {Part(ClosedSurface::from(inner), -1)});
  const std::vector<Vec3> points = {{1.2, 1.3, 1.4}, {0.2, 0.3, 0.4}, {3, 3, 3}};
  Monitor silent;
  const physics::BodyFieldValues field = physics::exact_field(body, points, Derivatives::second, 0, silent);
  const std::vector<double> densities = {2, 3, 0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Real truth = 3 * polyhedron(outer).at(points[i]).value - polyhedron(inner).at(points[i]).value;
    CHECK(std::abs(field.field.value[i] - double(truth)) <= 4e-15);
    CHECK(std::abs(field.density[i] - densities[i]) <= 1e-15);
    const SymmetricTensor& h = field.field.hessian[i];
    CHECK(std::abs(h[0] + h[3] + h[5] + 4 * std::numbers::pi * densities[i]) <= 4e-14);
  }
}

TEST_CASE("second derivatives on an edge are refused, value and gradient are not", "[polyhedron]") {
  const Body cube = body_of(box(Vec3::Ones()));
  const std::vector<Vec3> points = {{2, 2, 2}, {1, 1, 0.3}};
  Monitor silent;
  try {
    physics::exact_field(cube, points, Derivatives::second, 1, silent);
    FAIL("not refused");
  } catch (const Error& error) {
    CHECK(error.fault() == Fault::point_singular);
    CHECK_THAT(error.what(), Catch::Contains("the point (1, 1, 0.3)"));
  }
  const physics::BodyFieldValues field = physics::exact_field(cube, points, Derivatives::first, 1, silent);
  CHECK(field.field.hessian.empty());
  CHECK(field.field.gradient[1].x() < -1);
  struct Impatient final : Monitor {
    bool stopped() const override { return true; }
  } impatient;
  CHECK_THROWS_AS(physics::exact_field(cube, points, Derivatives::first, 1, impatient), Error);
}

TEST_CASE("outside, the series of a body falls on the polyhedron as the order grows", "[polyhedron][potential]") {
  std::vector<Body> bodies;
  bodies.push_back(body_of(box(Vec3(1, 2, 3))));
  bodies.push_back(body_of(scaled(icosphere(2), Vec3(1, 0.5, 0.3))));
  bodies.push_back(
      body_of(box(Vec3(1, 1, 1)), 1, {Part(ClosedSurface::from(box(Vec3(0.2, 0.3, 0.2), Vec3(2, 0, 0))), 5)}));
  const auto backend = make_cpu_backend();
  Monitor silent;
  for (const Body& body : bodies) {
    const Multipoles q = mass_moments(mass_problems(body, 80, default_cut_off), *backend, silent);
    for (const double far : {1.5, 3.0}) {
      std::vector<Vec3> points = points_outside(20, body.brillouin_radius * far, 1, 5), there = points;
      for (Vec3& p : there) p += body.origin;
      const auto truth = physics::exact_field(body, there, Derivatives::second, 0, silent).field;
      for (const int lmax : {0, 2, 4, 8, 20, 40, 80}) {
        const PotentialField found = potential(*backend, {q, lmax}, points);
        const double bound = std::max(1e-12, std::pow(1 / far, lmax + 1)), n = lmax + 2;
        for (std::size_t i = 0; i < points.size(); ++i) {
          CHECK(std::abs(found.value[i] / truth.value[i] - 1) <= bound);
          CHECK((found.gradient[i] - truth.gradient[i]).norm() <= n * bound * truth.gradient[i].norm());
          for (std::size_t c = 0; c < 6; ++c)
            CHECK(std::abs(found.hessian[i][c] - truth.hessian[i][c]) <=
                  n * n * bound * truth.value[i] / points[i].squaredNorm());
        }
      }
    }
  }
}

TEST_CASE("errors by order and distance fall as the series does, and say from where an order is good", "[potential]") {
  const Body body = body_of(box(Vec3(1, 2, 3)));
  const auto backend = make_cpu_backend();
  Monitor silent;
  const auto errors = physics::series_errors(body, {0, 2, 8}, {1, 2, 4}, *backend, 0, silent);
  REQUIRE(errors.rows.size() == 9);
  for (const auto& e : errors.rows) {
    CHECK(e.potential_rms <= e.potential_max);
    CHECK(e.acceleration_rms <= e.acceleration_max);
    CHECK(e.potential_max <= 2 * std::pow(1 / e.distance, e.order + 1));
  }
  // About the centre of mass order 0 lacks the quadrupole: its error falls like 1/r^2, and orders 2 and 8 (even ones alone
  // are there) like 1/r^4 and 1/r^10.
  CHECK(errors.rows[3].potential_max / errors.rows[6].potential_max == Approx(4).epsilon(0.15));
  CHECK(errors.rows[4].potential_max / errors.rows[7].potential_max == Approx(16).epsilon(0.4));
  REQUIRE(errors.good_from.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& good = errors.good_from[i];
    REQUIRE((good.distance[0] && good.distance[1] && good.distance[2]));
    CHECK(*good.distance[0] < *good.distance[1]);
    CHECK(*good.distance[1] < *good.distance[2]);
    // There, and a little farther out, it is; of each order one tolerance.
    const auto there =
        physics::series_errors(body, {good.order}, {std::min(1e6, *good.distance[i] * 1.001)}, *backend, 0, silent);
    CHECK(there.rows[0].acceleration_max <= physics::good_tolerances[i]);
    CHECK(there.rows[0].acceleration_max >= physics::good_tolerances[i] * 0.95);
  }
  CHECK(errors.truth_error <= 1e-13);
  CHECK_THROWS_AS(physics::series_errors(body, {0}, {0.5}, *backend, 0, silent), Error);
}

TEST_CASE("the benchmark cow is spherical to 1e-3 from 18 of its radii on, and a quadrupole from 5 on",
          "[potential][long]") {
  if (!benchmark_cow()) return skip_without_cow();
  const Body cow = make_body(*benchmark_cow(), {}, 1);
  const auto backend = make_cpu_backend();
  Monitor silent;
  const auto errors = physics::series_errors(cow, {0, 2, 8}, {1.5}, *backend, 0, silent);
  CHECK(*errors.good_from[0].distance[0] == Approx(17.732).epsilon(1e-3));
  CHECK(*errors.good_from[1].distance[0] == Approx(5.0745).epsilon(1e-3));
  CHECK(*errors.good_from[2].distance[2] == Approx(7.4805).epsilon(1e-3));
  CHECK(errors.rows[2].potential_max == Approx(3.4543e-4).epsilon(1e-3));
  check_at_most(errors.truth_error, 1e-14, "series of degree 40 against the polyhedron at 10 radii");
}
