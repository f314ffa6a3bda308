#include "host/spectrum/reconstruct.hpp"

#include "host/error.hpp"
#include "host/mesh/geometry.hpp"
#include "host/spectrum/surface_distance.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <functional>
#include <numbers>

using namespace cowgpu;
using test::check_at_most;

namespace {

constexpr double pi = std::numbers::pi;

/// The ellipsoid with these semi-axes about `centre` by direction: degree 1 exactly in x, y, z.
void set_ellipsoid(SurfaceExpansion& e, const Vec3& axes, const Vec3& centre) {
  for (int c = 0; c < 3; ++c) e.coefficients.at(3 + c, 0, 0) = centre[c] * std::sqrt(4 * pi);
  e.coefficients.at(3, 1, 1) = -axes.x() * std::sqrt(2 * pi / 3);
  e.coefficients.at(4, 1, 1) = {0, axes.y() * std::sqrt(2 * pi / 3)};
  e.coefficients.at(5, 1, 0) = axes.z() * std::sqrt(4 * pi / 3);
}

/// f of a surface given by direction, expanded on a grid of 2 lmax; the means of the angles are removed.
void set_f(SurfaceExpansion& e, Backend& backend, const std::function<Vec3(const Vec3&)>& place, double turn = 0) {
  Monitor silent;
  const int lmax = e.coefficients.lmax;
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 2 * lmax);
  const std::size_t n = grid.points(), length = std::size_t(grid.ring_length);
  std::vector<double> values(3 * n);
  for (std::size_t i = 0; i < n; ++i) {
    const double theta = grid.theta[i / length], phi = grid.phi(int(i % length));
    const Vec3 p =
        place({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)}) - e.origin;
    values[i] = p.norm();
    values[n + i] = std::atan2(std::hypot(p.x(), p.y()), p.z()) - theta;
    values[2 * n + i] = std::remainder(std::atan2(p.y(), p.x()) - phi, 2 * pi) + turn;
  }
  SphereCoefficients f(lmax, 3);
  backend.sphere_transform(grid, lmax)->analyse(3, values, f.values, silent);
  e.mean_dtheta = f.at(1, 0, 0).real() / std::sqrt(4 * pi);
  e.mean_dphi = f.at(2, 0, 0).real() / std::sqrt(4 * pi);
  f.at(1, 0, 0) = f.at(2, 0, 0) = 0;
  std::copy(f.values.begin(), f.values.end(), e.coefficients.values.begin());
}

Eigen::Matrix3d ellipsoid_inertia(const Vec3& axes, double volume, const Vec3& offset) {
  const Eigen::Matrix3d second =
      volume / 5 * Eigen::Matrix3d(axes.cwiseProduct(axes).asDiagonal()) + volume * offset * offset.transpose();
  return second.trace() * Eigen::Matrix3d::Identity() - second;
}

void check_measures(const SurfaceMeasures& m, const Vec3& axes, const Vec3& centre, const Vec3& origin, double figure) {
  const double volume = 4 * pi / 3 * axes.prod();
  const Eigen::Matrix3d inertia = ellipsoid_inertia(axes, volume, centre - origin);
  check_at_most(std::abs(m.volume / volume - 1), figure, "volume");
  check_at_most((m.centre_of_mass - centre).norm(), figure, "centre of mass");
  check_at_most((m.inertia - inertia).norm() / inertia.norm(), figure, "inertia");
}

} // namespace

TEST_CASE("an ellipsoid of degree 1 comes back with its closed-form volume, centre and inertia", "[reconstruct]") {
  Monitor silent;
  const auto backend = make_cpu_backend(2);
  const Vec3 axes(1.5, 0.7, 2), centre(0.3, -0.2, 0.5);
  SurfaceExpansion e;
  e.coefficients = SphereCoefficients(12, 6);
  e.origin = {0.1, 0.1, 0.1};
  set_ellipsoid(e, axes, centre);
  for (const int order : {1, 2, 7, 12})
    check_measures(measure(e, SurfaceFields::xyz, order, *backend, silent), axes, centre, e.origin, 3e-15);

  const SphereTriangulation sphere = icosphere(4);
  const TriangleSurface surface = reconstruct(e, SurfaceFields::xyz, 5, sphere, 2, silent);
  REQUIRE(surface.vertices.size() == sphere.directions.size());
  CHECK(surface.faces == sphere.faces);
  double worst = 0, tilt = 0;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const Vec3& d = sphere.directions[v];
    worst = std::max(worst, (surface.vertices[v] - centre - axes.cwiseProduct(d)).norm());
    tilt = std::max(tilt, (surface.normals[v] - d.cwiseQuotient(axes).normalized()).norm());
  }
  check_at_most(worst, 3e-15, "vertices");
  check_at_most(tilt, 4e-2, "normals");
  // Triangles with corners on an ellipsoid hold less than it does, by the square of their size.
  const double inside = volume(surface.vertices, surface.faces) / (4 * pi / 3 * axes.prod());
  CHECK(inside < 1);
  CHECK(inside > 1 - 4e-3);
}

TEST_CASE("a grid and its own directions give the same closed surface", "[reconstruct]") {
  Monitor silent;
  const auto backend = make_cpu_backend(2);
  SurfaceExpansion e;
  e.coefficients = SphereCoefficients(9, 6);
  set_ellipsoid(e, {1, 1, 1}, {5, 0, 0});
  e.coefficients.at(3, 7, 3) = {0.01, -0.02};
  e.coefficients.at(4, 9, 0) = 0.015;
  e.coefficients.at(5, 9, 9) = {-0.01, 0.01};
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, 20);
  const SphereTriangulation sphere = triangulation(grid);
  for (const int order : {0, 1, 7, 9}) {
    const TriangleSurface a = reconstruct(e, SurfaceFields::xyz, order, grid, *backend, silent);
    const TriangleSurface b = reconstruct(e, SurfaceFields::xyz, order, sphere, 2, silent);
    CHECK(a.faces == b.faces);
    double worst = 0;
    REQUIRE(a.vertices.size() == b.vertices.size());
    for (std::size_t v = 0; v < a.vertices.size(); ++v) worst = std::max(worst, (a.vertices[v] - b.vertices[v]).norm());
    check_at_most(worst, 8e-15, "grid against directions");
  }
  // Closed, of genus 0 and outwards: what ManifoldSurface asks for.
  RawMesh mesh;
  mesh.vertices = sphere.directions;
  mesh.faces = sphere.faces;
  CHECK_NOTHROW(ManifoldSurface::from(ClosedSurface::from(mesh)));
  CHECK(mesh.vertices.size() + mesh.faces.size() - mesh.faces.size() * 3 / 2 == 2);
  CHECK_THROWS_AS(triangulation(make_grid(GridKind::gauss_legendre, 4)), Error);
  CHECK_THROWS_AS(triangulation(make_grid(GridKind::clenshaw_curtis, 0)), Error);
}

TEST_CASE("order 0 is the spherical cow, whatever the fields", "[reconstruct]") {
  Monitor silent;
  const auto backend = make_cpu_backend(2);
  SurfaceExpansion e;
  e.coefficients = SphereCoefficients(3, 6);
  e.origin = {1, 2, 3};
  e.mean_dphi = 0.4;
  e.coefficients.at(0, 0, 0) = 0.5825 * std::sqrt(4 * pi);
  set_ellipsoid(e, {3, 2, 1}, {7, 7, 7});
  CHECK(spherical_radius(e) == Approx(0.5825).epsilon(1e-15));
  for (const SurfaceFields fields : {SurfaceFields::xyz, SurfaceFields::f}) {
    const TriangleSurface ball = reconstruct(e, fields, 0, icosphere(1), 1, silent);
    for (const Vec3& v : ball.vertices) CHECK((v - e.origin).norm() == Approx(0.5825).epsilon(1e-14));
    check_measures(measure(e, fields, 0, *backend, silent), Vec3::Constant(0.5825), e.origin, e.origin, 3e-15);
  }
  CHECK_THAT(describe_order(e, SurfaceFields::xyz, 0), Catch::Contains("point at order 0 and starts at order 1"));
  CHECK_THAT(describe_order(e, SurfaceFields::f, 0), !Catch::Contains("point"));
}

TEST_CASE("the fields f rebuild an ellipsoid to the tail of its series", "[reconstruct]") {
  Monitor silent;
  const auto backend = make_cpu_backend(2);
  const Vec3 axes(1.1, 0.95, 1.0), centre(0.03, -0.02, 0.01);
  SurfaceExpansion e;
  e.coefficients = SphereCoefficients(48, 6);
  // Where the axes differ, dphi has no limit at the poles, and its series converges slowly.
  e.origin = centre;
  set_f(e, *backend, [&](const Vec3& d) { return Vec3(centre + axes.cwiseProduct(d)); });
  const SphereTriangulation sphere = icosphere(4);
  double last = 1;
  for (const int order : {4, 16, 48}) {
    const TriangleSurface surface = reconstruct(e, SurfaceFields::f, order, sphere, 2, silent);
    double worst = 0;
    for (std::size_t v = 0; v < surface.vertices.size(); ++v)
      worst = std::max(worst, (surface.vertices[v] - centre - axes.cwiseProduct(sphere.directions[v])).norm());
    INFO(order << ": " << worst);
    CHECK(worst < last);
    last = worst;
  }
  check_at_most(last, 3e-3, "distance at order 48");
  check_measures(measure(e, SurfaceFields::f, 48, *backend, silent), axes, centre, e.origin, 2e-5);
}

TEST_CASE("removed means are put back", "[reconstruct]") {
  Monitor silent;
  const auto backend = make_cpu_backend(2);
  SurfaceExpansion e;
  e.coefficients = SphereCoefficients(4, 6);
  set_f(
      e, *backend, [](const Vec3& d) { return Vec3(2 * d); }, 0.7); // turned about z
  CHECK(e.mean_dphi == Approx(0.7).epsilon(1e-13));
  const SphereTriangulation sphere = icosphere(1);
  const TriangleSurface surface = reconstruct(e, SurfaceFields::f, 4, sphere, 1, silent);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3::UnitZ()).toRotationMatrix();
  double worst = 0;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v)
    worst = std::max(worst, (surface.vertices[v] - 2 * (turn * sphere.directions[v])).norm());
  check_at_most(worst, 5e-15, "vertices");
}

TEST_CASE("a map that turns the surface inside out has a negative volume", "[reconstruct]") {
  Monitor silent;
  const auto backend = make_cpu_backend(1);
  SurfaceExpansion e;
  e.coefficients = SphereCoefficients(2, 6);
  set_ellipsoid(e, {1, 1, -1}, {0, 0, 0});
  CHECK(measure(e, SurfaceFields::xyz, 2, *backend, silent).volume == Approx(-4 * pi / 3).epsilon(1e-14));
}

TEST_CASE("what cannot be rebuilt is refused", "[reconstruct]") {
  Monitor silent;
  const auto backend = make_cpu_backend(1);
  SurfaceExpansion e;
  e.coefficients = SphereCoefficients(2, 6);
  const SphereTriangulation sphere = icosphere(0);
  CHECK_THROWS_AS(reconstruct(e, SurfaceFields::xyz, 3, sphere, 1, silent), Error);
  CHECK_THROWS_AS(reconstruct(e, SurfaceFields::xyz, -1, sphere, 1, silent), Error);
  CHECK_THROWS_AS(measure(e, SurfaceFields::xyz, 3, *backend, silent), Error);
  e.signed_dphi = false;
  CHECK_THROWS_AS(reconstruct(e, SurfaceFields::f, 2, sphere, 1, silent), Error);
  CHECK_NOTHROW(reconstruct(e, SurfaceFields::xyz, 2, sphere, 1, silent));
  e.coefficients = SphereCoefficients(2, 3);
  CHECK_THROWS_AS(reconstruct(e, SurfaceFields::xyz, 1, sphere, 1, silent), Error);
}

TEST_CASE("what distance and angles bound is measured with the disks that close its poles", "[reconstruct]") {
  const auto backend = make_cpu_backend(2);
  Monitor silent;
  SurfaceExpansion e;
  e.origin = {0.5, -0.25, 1};
  e.coefficients = SphereCoefficients(5, 6);
  e.coefficients.at(0, 0, 0) = 3;
  e.coefficients.at(0, 3, 1) = {0.1, 0.05};
  e.coefficients.at(1, 1, 0) = 0.4; // theta' is 0.195 at one pole and pi - 0.195 at the other
  e.coefficients.at(1, 2, 0) = 0.2;
  e.coefficients.at(2, 2, 1) = {0.05, -0.1};
  const SurfaceMeasures found = measure(e, SurfaceFields::f, 5, *backend, silent);
  // The mesh's poles are points of those circles, which costs it an error of first order.
  const auto error_of = [&](int degree) {
    const TriangleSurface mesh =
        reconstruct(e, SurfaceFields::f, 5, make_grid(GridKind::clenshaw_curtis, degree), *backend, silent);
    return Eigen::Vector2d(volume(mesh.vertices, mesh.faces) / found.volume - 1,
                           (centre_of_mass(mesh.vertices, mesh.faces) - found.centre_of_mass).norm());
  };
  const Eigen::Vector2d coarse = error_of(256), fine = error_of(512);
  check_at_most(coarse.cwiseAbs().maxCoeff(), 1e-3, "at 256");
  check_at_most((2 * fine - coarse).cwiseAbs().maxCoeff(), 4e-5, "extrapolated");
}
