#include "tests/support/compare_polyhedron.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

constexpr double pi = std::numbers::pi;

} // namespace

TEST_CASE("the potential of a cube is known at its middle and its corners", "[polyhedron]") {
  Paths paths;
  const RawMesh mesh = box({1, 1, 1});
  // E. Durand, Electrostatique; at a corner half of that: eight cubes of twice the size meet there.
  const double middle = 3 * std::log((std::sqrt(3.0) + 1) / (std::sqrt(3.0) - 1)) - pi / 2;
  const std::vector<Vec3> points = {{0.5, 0.5, 0.5}, {0, 0, 0}, {1, 1, 1}, {0, 1, 0}};
  paths.each([&](Backend& backend) {
    const PolyhedronValues found = polyhedron(backend, polyhedron_problem(mesh), points);
    CHECK(std::fabs(found.field.value[0] - middle) < 4e-15);
    CHECK(found.field.gradient[0].norm() < 4e-15);
    for (std::size_t i = 1; i < 4; ++i) {
      CHECK(std::fabs(found.field.value[i] - middle / 2) < 4e-15);
      // By symmetry along the diagonal.
      const Vec3 sizes = found.field.gradient[i].cwiseAbs();
      check_at_most(sizes.maxCoeff() - sizes.minCoeff(), 4e-14, "along the diagonal");
    }
    // A third of the trace each.
    for (const std::size_t k : {0, 3, 5}) CHECK(std::fabs(found.field.hessian[0][k] + 4 * pi / 3) < 2e-14);
  });
}

TEST_CASE("a ball of facets has a ball's field to the order of its facets", "[polyhedron]") {
  Paths paths;
  const std::vector<Vec3> points = {{0.1, -0.2, 0.3}, {1.1, 0.4, 0}, {-1.5, 1, 2}, {40, 50, 60}};
  paths.each([&](Backend& backend) {
    double before = 0;
    for (int level = 2; level < 5; ++level) {
      const RawMesh mesh = icosphere(level);
      const PolyhedronValues found = polyhedron(backend, polyhedron_problem(mesh), points);
      double worst = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double r = points[i].norm(), value = r < 1 ? 2 * pi * (1 - r * r / 3) : 4 * pi / 3 / r;
        const Vec3 gradient = points[i] * (r < 1 ? -4 * pi / 3 : -4 * pi / 3 / (r * r * r));
        worst = std::max({worst, std::fabs(found.field.value[i] / value - 1),
                          (found.field.gradient[i] - gradient).norm() / gradient.norm()});
      }
      INFO(fmt::format("level {}: {}", level, worst));
      CHECK(worst < 0.06 / std::pow(4.0, level - 2));
      if (before > 0) CHECK(std::fabs(before / worst - 4) < 0.3);
      before = worst;
    }
  });
}

TEST_CASE("fields of bodies add up, cavities are taken off", "[polyhedron]") {
  Paths paths;
  const RawMesh first = icosphere(2), second = translated(scaled(icosphere(2), {0.3, 0.2, 0.1}), {0.1, 0, 0.2});
  const RawMesh far = translated(first, {0.5, 0.25, 0});
  const auto points = points_about(first, 40, 21);
  paths.each([&](Backend& backend) {
    const auto field = [&](const RawMesh& mesh) {
      return polyhedron(backend, polyhedron_problem(mesh, Derivatives::first), points);
    };
    const PolyhedronValues a = field(first), b = field(second), c = field(far),
                           hollow = field(together(first, flipped(second))), overlapping = field(together(first, far)),
                           twice = field(together(first, first)), gone = field(together(first, flipped(first)));
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double scale = a.field.value[i];
      CHECK(std::fabs(hollow.field.value[i] - (a.field.value[i] - b.field.value[i])) < 1e-14 * scale);
      CHECK(std::fabs(overlapping.field.value[i] - (a.field.value[i] + c.field.value[i])) < 1e-14 * scale);
      CHECK(std::fabs(overlapping.winding[i] - (a.winding[i] + c.winding[i])) < 1e-14);
      CHECK((overlapping.field.gradient[i] - a.field.gradient[i] - c.field.gradient[i]).norm() < 3e-14 * scale);
      CHECK(std::fabs(twice.field.value[i] - 2 * a.field.value[i]) < 1e-14 * scale);
      CHECK(std::fabs(gone.field.value[i]) < 1e-14 * scale);
      CHECK(gone.field.gradient[i].norm() < 3e-14 * scale);
    }
  });
}

TEST_CASE("the field next to edges is right at any distance", "[polyhedron]") {
  Paths paths;
  const RawMesh mesh = icosphere(2);
  std::vector<Vec3> points;
  for (int k = 3; k <= 15; ++k)
    for (std::size_t f = 0; f < 4; ++f) {
      const Face& face = mesh.faces[37 * f + std::size_t(k)];
      const Vec3 &a = mesh.vertices[face[0]], &b = mesh.vertices[face[1]];
      const Vec3 normal = (b - a).cross(mesh.vertices[face[2]] - a).normalized(),
                 side = (b - a).normalized().cross(normal);
      const double turn = 1.5 * double(f) + k, away = std::pow(10.0, -k) * (b - a).norm();
      points.emplace_back(a * 0.3 + b * 0.7 + (side * std::cos(turn) + normal * std::sin(turn)) * away);
    }
  // Second derivatives and angles are as badly conditioned there as 1 over the distance. The reference takes what is nearer than
  // 4 units in the last place for on the edge: that is 1e-15 of the field.
  compare_polyhedron(paths, polyhedron_problem(mesh, Derivatives::first), points, {4e-14, 0});
}

TEST_CASE("needles have the field of what they are a part of", "[polyhedron]") {
  Paths paths;
  // A face cut at a point so near to an edge that it makes a needle; the body is the same but for its height.
  for (const auto& [exponent, figure] :
       {std::pair(3, 1e-14), std::pair(6, 2e-14), std::pair(9, 2e-12), std::pair(11, 4e-11)}) {
    RawMesh mesh = icosphere(1);
    std::vector<Vec3> points;
    const double height = std::pow(10.0, -exponent);
    for (std::size_t f = 0; f < 40; ++f) {
      const Face face = mesh.faces[f];
      const Vec3 a = mesh.vertices[face[0]], b = mesh.vertices[face[1]], c = mesh.vertices[face[2]];
      const Vec3 cut = a * (0.5 - height / 2) + b * (0.5 - height / 2) + c * height;
      const auto id = std::uint32_t(mesh.vertices.size());
      mesh.vertices.push_back(cut);
      mesh.faces[f] = {face[0], face[1], id};
      mesh.faces.push_back({face[1], face[2], id});
      mesh.faces.push_back({face[2], face[0], id});
      if (f % 4 == 0) points.insert(points.end(), {cut, (a + b + cut) / 3, (b + c + cut) / 3});
    }
    INFO("height 1e-" << exponent);
    compare_polyhedron(paths, polyhedron_problem(mesh, Derivatives::first), points, {figure, 0});
  }
}

TEST_CASE("a body far from the origin has the field of one there", "[polyhedron]") {
  Paths paths;
  RawMesh mesh = icosphere(2);
  // Multiples of 2^-20, which moving by 2^12 does not round.
  for (Vec3& v : mesh.vertices) v = (v * 0x1p20).array().round().matrix() * 0x1p-20;
  const Vec3 shift = Vec3::Constant(0x1p12);
  const RawMesh moved = translated(mesh, shift);
  std::vector<Vec3> points = points_about(mesh, 60, 4), moved_points;
  for (Vec3& p : points) {
    p = (p * 0x1p20).array().round().matrix() * 0x1p-20;
    moved_points.emplace_back(p + shift);
  }
  paths.each([&](Backend& backend) {
    const PolyhedronValues a = polyhedron(backend, polyhedron_problem(mesh, Derivatives::first), points),
                           b = polyhedron(backend, polyhedron_problem(moved, Derivatives::first), moved_points);
    double value = 0, gradient = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      value = std::max(value, std::fabs(a.field.value[i] / b.field.value[i] - 1));
      gradient = std::max(gradient, (a.field.gradient[i] - b.field.gradient[i]).norm() / a.field.value[i]);
    }
    check_at_most(value, 1e-14, "V");
    check_at_most(gradient, 1e-14, "gradient");
  });
}

TEST_CASE("far away no digits are lost", "[polyhedron]") {
  Paths paths;
  const RawMesh mesh = box({1, 2, 3});
  std::vector<Vec3> points;
  for (int k = 1; k < 100; k += 7) points.emplace_back(Vec3(1, 2, -1).normalized() * std::pow(10.0, k));
  const Vec3 middle(0.5, 1, 1.5);
  paths.each([&](Backend& backend) {
    const PolyhedronValues found = polyhedron(backend, polyhedron_problem(mesh, Derivatives::first), points);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Vec3 r = points[i] - middle;
      // Mass and quadrupole: of degree 4 is left 1e-30.
      const Eigen::Matrix3d second = Vec3(1, 4, 9).asDiagonal() * (6.0 / 12);
      const double n = r.stableNorm();
      const Vec3 u = r / n;
      const double value = 6 / n * (1 + (3 * u.dot(second * u) - second.trace()) / 6 / (2 * n * n));
      CHECK(std::fabs(found.field.value[i] / value - 1) < 2e-15);
      CHECK(std::fabs(found.field.gradient[i].stableNorm() / (6 / n) * n - 1) < 1e-13);
      CHECK(found.winding[i] == 0);
    }
  });
}
