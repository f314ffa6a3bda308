#include "host/spectrum/expand_surface.hpp"

#include "host/error.hpp"
#include "host/map/harmonic.hpp"
#include "host/map/smooth.hpp"
#include "host/map/stretch.hpp"
#include "host/mesh/builtin.hpp"
#include "host/paper/recipe.hpp"
#include "host/paper/surface_tables.hpp"
#include "host/spectrum/rotation.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

const double sqrt_4pi = std::sqrt(4 * std::numbers::pi);

SphereMap radial_map(const std::vector<Vec3>& vertices) {
  SphereMap map;
  for (const Vec3& v : vertices) map.positions.push_back(v.normalized());
  return map;
}

SurfaceExpansion expand(const RawMesh& mesh, const SphereMap& map, const ExpandSurfaceOptions& options,
                        ExpandSurfaceReport* report = nullptr) {
  const auto backend = make_cpu_backend();
  Monitor monitor;
  return expand_surface(mesh.vertices, mesh.faces, map, options, *backend, monitor, report);
}

double largest(const SurfaceExpansion& expansion, int field, int from_degree) {
  double most = 0;
  for (int l = from_degree; l <= expansion.coefficients.lmax; ++l)
    for (int m = 0; m <= l; ++m) most = std::max(most, std::abs(expansion.coefficients.at(field, l, m)));
  return most;
}

} // namespace

TEST_CASE("radial projection moves no direction: both angles of a body inscribed in a sphere vanish",
          "[expand_surface]") {
  const RawMesh mesh = box({2, 3, 4}, {-1, -1.5, -2});
  ExpandSurfaceOptions options;
  options.lmax = 20;
  ExpandSurfaceReport report;
  const SurfaceExpansion expansion = expand(mesh, radial_map(mesh.vertices), options, &report);
  CHECK(largest(expansion, 1, 0) < 2e-15);
  CHECK(largest(expansion, 2, 0) < 6e-15);
  CHECK(std::abs(expansion.mean_dtheta) < 1e-15);
  CHECK(std::abs(expansion.mean_dphi) < 1e-15);
  CHECK(largest(expansion, 0, 1) > 0.1);
  CHECK(report.rings == 257);
  CHECK(report.flipped_faces == 0);
  CHECK(report.faces_hit == mesh.faces.size());
}

TEST_CASE("a sphere of triangles has a constant f_r up to its sagitta, and x, y, z of degree 1", "[expand_surface]") {
  const double radius = 3;
  const RawMesh coarse = icosphere(3, radius), fine = icosphere(4, radius);
  ExpandSurfaceOptions options;
  options.lmax = 64;
  const SurfaceExpansion a = expand(coarse, radial_map(coarse.vertices), options),
                         b = expand(fine, radial_map(fine.vertices), options);
  const double off_a = radius * sqrt_4pi - a.coefficients.at(0, 0, 0).real(),
               off_b = radius * sqrt_4pi - b.coefficients.at(0, 0, 0).real();
  CHECK(off_a > 0);
  CHECK(off_a / off_b == Approx(4).epsilon(0.01));
  CHECK(largest(a, 0, 1) < off_a);
  // x = r sin theta cos phi = -r sqrt(2 pi / 3) (Y_11 - Y_1,-1), z = r sqrt(4 pi / 3) Y_10
  const double x = radius * std::sqrt(2 * std::numbers::pi / 3);
  CHECK(std::abs(b.coefficients.at(3, 1, 1) + x) < off_b);
  CHECK(std::abs(b.coefficients.at(4, 1, 1) - std::complex<double>(0, x)) < off_b);
  CHECK(std::abs(b.coefficients.at(5, 1, 0) - x * std::sqrt(2)) < off_b);
  for (const int field : {3, 4, 5}) CHECK(largest(b, field, 2) < off_b);
}

TEST_CASE("a turn of the map about z is the mean of f_dphi, wrapped, and absolute where asked for",
          "[expand_surface]") {
  const RawMesh mesh = box({2, 3, 4}, {-1, -1.5, -2});
  for (const double turn : {0.7, -2.0, 3.0, 4.0}) {
    SphereMap map = radial_map(mesh.vertices);
    for (Vec3& p : map.positions) p = Eigen::AngleAxisd(turn, Vec3::UnitZ()) * p;
    const double expected = turn > std::numbers::pi ? 2 * std::numbers::pi - turn : -turn;
    ExpandSurfaceOptions options;
    options.lmax = 6;
    const SurfaceExpansion expansion = expand(mesh, map, options);
    CHECK(expansion.mean_dphi == Approx(expected).epsilon(1e-14));
    CHECK(largest(expansion, 2, 0) < 2e-14);
    CHECK(expansion.signed_dphi);
    options.signed_dphi = false;
    const SurfaceExpansion absolute = expand(mesh, map, options);
    CHECK(absolute.mean_dphi == Approx(std::abs(expected)).epsilon(1e-14));
    CHECK_FALSE(absolute.signed_dphi);
  }
}

TEST_CASE("the origin moves f_r and leaves x, y, z in mesh coordinates", "[expand_surface]") {
  const RawMesh mesh = box({2, 3, 4}, {-1, -1.5, -2});
  const SphereMap map = radial_map(mesh.vertices);
  ExpandSurfaceOptions options;
  options.lmax = 5;
  const SurfaceExpansion first = expand(mesh, map, options);
  options.origin = {0.2, -0.1, 0.3};
  const SurfaceExpansion second = expand(mesh, map, options);
  for (int field = 3; field < 6; ++field)
    for (int l = 0; l <= 5; ++l)
      for (int m = 0; m <= l; ++m) CHECK(first.coefficients.at(field, l, m) == second.coefficients.at(field, l, m));
  CHECK(std::abs(first.coefficients.at(0, 1, 0) - second.coefficients.at(0, 1, 0)) > 0.1);
  CHECK(second.origin == options.origin);
  RawMesh moved = translated(mesh, -options.origin);
  options.origin = Vec3::Zero();
  const SurfaceExpansion third = expand(moved, map, options);
  for (int field = 0; field < 3; ++field)
    for (int l = 0; l <= 5; ++l)
      for (int m = 0; m <= l; ++m)
        CHECK(std::abs(third.coefficients.at(field, l, m) - second.coefficients.at(field, l, m)) < 2e-14);
}

TEST_CASE("the estimate of aliasing falls with the grid and is there only if asked for", "[expand_surface]") {
  const RawMesh mesh = box({2, 3, 4}, {-1, -1.5, -2});
  const SphereMap map = radial_map(mesh.vertices);
  ExpandSurfaceOptions options;
  double before = 1;
  for (const int lmax : {128, 256, 512}) {
    options.lmax = lmax;
    options.estimate_aliasing = true;
    ExpandSurfaceReport report;
    expand(mesh, map, options, &report);
    REQUIRE(report.aliasing.size() == std::size_t(lmax) + 1);
    double sum = 0;
    for (int l = 0; l <= 64; ++l) sum += std::pow(report.aliasing[std::size_t(l)][0], 2);
    CHECK(sum > 0);
    CHECK(std::sqrt(sum) < before / 2);
    before = std::sqrt(sum);
  }
  options.estimate_aliasing = false;
  ExpandSurfaceReport report;
  expand(mesh, map, options, &report);
  CHECK(report.aliasing.empty());
}

TEST_CASE("what aliasing and truncation are estimated to be is what a larger expansion finds", "[expand_surface]") {
  std::mt19937 random(4);
  const RawMesh mesh = convex_polyhedron(random, 40, 100);
  SphereMap map; // directions from a point inside, so that no field is simple
  for (const Vec3& v : mesh.vertices) map.positions.push_back((v - Vec3(5, -8, 11)).normalized());
  const Eigen::Matrix3d tilt = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& p : map.positions) p = tilt * p;
  ExpandSurfaceOptions options;
  options.lmax = 128;
  options.estimate_aliasing = true;
  ExpandSurfaceReport report;
  const SurfaceExpansion small = expand(mesh, map, options, &report);
  options.lmax = 1024; // an eighth of the cell: aliasing is negligible beside the other's
  options.estimate_aliasing = false;
  ExpandSurfaceReport fine;
  const SurfaceExpansion large = expand(mesh, map, options, &fine);
  REQUIRE(report.truncation.size() == 129);
  for (int f = 0; f < 6; ++f) {
    INFO(surface_field_names[std::size_t(f)]);
    std::size_t missed = 0;
    double error = 0, estimate = 0;
    for (int l = 0; l <= 128; ++l) {
      double sum = 0;
      for (int m = 0; m <= l; ++m)
        sum += (m == 0 ? 1 : 2) * std::norm(small.coefficients.at(f, l, m) - large.coefficients.at(f, l, m));
      error += sum;
      estimate += std::pow(report.aliasing[std::size_t(l)][std::size_t(f)], 2);
      missed += std::sqrt(sum) > report.aliasing[std::size_t(l)][std::size_t(f)];
      const double left = report.truncation[std::size_t(l)][std::size_t(f)];
      CHECK(fine.truncation[std::size_t(l)][std::size_t(f)] == Approx(left).epsilon(0.02));
    }
    INFO(missed << " degrees of 129 above their estimate; in all " << std::sqrt(error / estimate) << " of it");
    CHECK(missed <= 12);
    CHECK(error < estimate);
  }
}

TEST_CASE("both paths expand a surface alike", "[expand_surface]") {
  const RawMesh mesh = builtin_mesh("cow@1");
  const auto surface = ManifoldSurface::from(ClosedSurface::from(mesh));
  Monitor monitor;
  Paths paths;
  for (const SphereMap& map : {harmonic_map(surface), stretch_map(surface, {}, monitor)})
    for (const int lmax : {0, 1, 7, 13, 512}) {
      INFO(name(map.method) << ", lmax " << lmax);
      ExpandSurfaceOptions options;
      options.lmax = lmax;
      options.origin = {0.1, 0.3, 0};
      options.estimate_aliasing = lmax < 512;
      std::optional<SurfaceExpansion> first;
      ExpandSurfaceReport first_report;
      paths.each([&](Backend& backend) {
        INFO(backend.facts().name);
        ExpandSurfaceReport report;
        SurfaceExpansion found = expand_surface(mesh.vertices, mesh.faces, map, options, backend, monitor, &report);
        CHECK(report.rings == std::max(257, 2 * lmax + 1));
        CHECK(report.faces_hit > 0);
        CHECK(report.truncation.size() == std::size_t(lmax) + 1);
        if (!first) {
          first = std::move(found);
          first_report = report;
          return;
        }
        double apart = std::abs(found.mean_dphi - first->mean_dphi) + std::abs(found.mean_dtheta - first->mean_dtheta);
        for (std::size_t i = 0; i < found.coefficients.values.size(); ++i)
          apart = std::max(apart, std::abs(found.coefficients.values[i] - first->coefficients.values[i]));
        check_at_most(apart, 8e-15, "coefficients");
        CHECK(report.faces_hit == first_report.faces_hit);
        CHECK(report.flipped_faces == first_report.flipped_faces);
        CHECK(report.folded_points == first_report.folded_points);
        CHECK(report.aliasing.size() == first_report.aliasing.size());
        for (std::size_t l = 0; l < report.aliasing.size(); ++l)
          for (std::size_t f = 0; f < 6; ++f)
            CHECK(std::abs(report.aliasing[l][f] - first_report.aliasing[l][f]) < 8e-15);
      });
    }
}

namespace {

// The largest difference between the coefficients of a turned body's surface and the turned coefficients, degrees 0 to 8,
// against the largest coefficient: f_r, and the position, whose components turn as well.
std::array<double, 2> turned_apart(const RawMesh& mesh, const std::function<SphereMap(const ManifoldSurface&)>& make) {
  const EulerAngles angles{0.7, 1.1, -0.4};
  const Eigen::Matrix3d rotation = rotation_matrix(angles);
  const auto expanded = [&](const RawMesh& body) {
    const auto surface = ManifoldSurface::from(ClosedSurface::from(body));
    ExpandSurfaceOptions options;
    options.lmax = 8;
    return expand(body, make(surface), options).coefficients;
  };
  Monitor monitor;
  const SphereCoefficients straight = rotate(expanded(mesh), angles, monitor),
                           turned = expanded(rotated(mesh, rotation));
  std::array<double, 2> apart{};
  double largest = 0;
  for (int l = 0; l <= 8; ++l)
    for (int m = 0; m <= l; ++m) {
      largest = std::max(largest, std::abs(turned.at(0, l, m)));
      apart[0] = std::max(apart[0], std::abs(turned.at(0, l, m) - straight.at(0, l, m)));
      for (int i = 0; i < 3; ++i) {
        std::complex<double> want = 0;
        for (int j = 0; j < 3; ++j) want += rotation(i, j) * straight.at(3 + j, l, m);
        apart[1] = std::max(apart[1], std::abs(turned.at(3 + i, l, m) - want));
      }
    }
  return {apart[0] / largest, apart[1] / largest};
}

} // namespace

TEST_CASE("turning the body turns the coefficients of its surface, over every map", "[expand_surface]") {
  // What is left is aliasing: the grid does not turn.
  const RawMesh mesh = builtin_mesh("cow@1");
  Monitor monitor;
  HarmonicOptions plain, polished;
  plain.pole.rule = polished.pole.rule = Pole::Rule::vertex;
  plain.pole.vertex = polished.pole.vertex = 100;
  plain.polish = false;
  polished.polish = true;
  const auto check = [&](const char* what, double figure,
                         const std::function<SphereMap(const ManifoldSurface&)>& make) {
    const auto apart = turned_apart(mesh, make);
    check_at_most(apart[0], figure, std::string("f_r over the map ") + what);
    check_at_most(apart[1], figure, std::string("x, y, z over the map ") + what);
  };
  check("harmonic", 1e-5, [&](const ManifoldSurface& s) { return harmonic_map(s, plain); });
  check("polished", 1e-5, [&](const ManifoldSurface& s) { return harmonic_map(s, polished); });
  check("smooth", 1e-5, [&](const ManifoldSurface& s) { return smooth_map(s); });
  check("stretch", 1e-5, [&](const ManifoldSurface& s) { return stretch_map(s, {}, monitor); });
}

TEST_CASE("maps of another mesh and degrees out of range are refused", "[expand_surface]") {
  const RawMesh mesh = box({1, 1, 1}, {-0.5, -0.5, -0.5});
  SphereMap map = radial_map(mesh.vertices);
  ExpandSurfaceOptions options;
  for (const int lmax : {-1, largest_surface_degree + 1}) {
    options.lmax = lmax;
    CHECK_THROWS_AS(expand(mesh, map, options), Error);
  }
  options.lmax = 2;
  options.origin.x() = NAN;
  CHECK_THROWS_AS(expand(mesh, map, options), Error);
  options.origin = Vec3::Zero();
  map.positions.pop_back();
  CHECK_THROWS_AS(expand(mesh, map, options), Error);
}

TEST_CASE("the paper's recipe gives the paper's table of the harmonic map", "[expand_surface][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const SphereMap map = harmonic_map(ManifoldSurface::from(*cow), paper::harmonic_map());
  ExpandSurfaceOptions options;
  options.lmax = 3;
  options.closest_point = true;
  options.signed_dphi = false;
  const SurfaceExpansion expansion = expand(cow->mesh(), map, options);
  const auto distances = paper_distances(expansion);
  CHECK(distances[0] < 2e-4);
  CHECK(distances[1] < 1.1e-3);
  CHECK(distances[2] < 1.8e-3);
  const auto misfits = paper_misfits(expansion);
  CAPTURE(misfits[0], misfits[1], misfits[2]);
  CHECK(misfits[0] <= 0.003);
  CHECK(misfits[1] <= 0.001);
  CHECK(misfits[2] <= 0.0015);
  CHECK(std::abs(expansion.coefficients.at(0, 0, 0).real() - 0.5825) <= 2e-4);
  CHECK(expansion.coefficients.at(1, 0, 0) == 0.0);
  // Signed, f_dphi is another function altogether.
  options.signed_dphi = true;
  CHECK(paper_misfits(expand(cow->mesh(), map, options))[2] > 1);
}
