#include "host/geometry/orientation.hpp"
#include "host/map/canonical_surface.hpp"
#include "host/map/collapse.hpp"
#include "host/map/stretch_energy.hpp"
#include "host/map/stretch_newton.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>

using namespace cowgpu;

namespace {

Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

// Corners of a positive triangle of about this size on the sphere.
std::array<Vec3, 3> random_triangle(std::mt19937& random, double size) {
  for (;;) {
    const Vec3 centre = random_direction(random);
    std::array<Vec3, 3> x;
    for (Vec3& corner : x) corner = (centre + size * random_direction(random)).normalized();
    if (x[0].dot((x[1] - x[0]).cross(x[2] - x[0])) > 0.1 * size * size) return x;
  }
}

StretchWeights random_weights(std::mt19937& random, double lambda) {
  return stretch_weights(random_direction(random), random_direction(random), random_direction(random), lambda);
}

Vec3 moved(const Frame& frame, double p, double q) {
  return (frame.row(2) + p * frame.row(0) + q * frame.row(1)).transpose().normalized();
}

std::vector<std::uint32_t> from_smallest(std::span<const std::uint32_t> ring) {
  std::vector<std::uint32_t> r(ring.begin(), ring.end());
  if (!r.empty()) std::rotate(r.begin(), std::min_element(r.begin(), r.end()), r.end());
  return r;
}

ManifoldSurface manifold(RawMesh mesh) {
  return ManifoldSurface::from(ClosedSurface::from(std::move(mesh)));
}

} // namespace

TEST_CASE("the stretch of a small triangle is half the squared singular values of its affine map", "[stretch]") {
  std::mt19937 random(1);
  for (int repeat = 0; repeat < 50; ++repeat) {
    const double size = 1e-4; // so small that det/2 is the triangle's area
    const auto x = random_triangle(random, size);
    const std::array<Vec3, 3> v = {random_direction(random), random_direction(random), random_direction(random)};
    // Planar coordinates of both triangles, and the map from x's to v's.
    const auto planar = [](const std::array<Vec3, 3>& t) {
      const Vec3 u = (t[1] - t[0]).normalized(), n = (t[1] - t[0]).cross(t[2] - t[0]).normalized(), w = n.cross(u);
      Eigen::Matrix2d m;
      m << u.dot(t[1] - t[0]), u.dot(t[2] - t[0]), w.dot(t[1] - t[0]), w.dot(t[2] - t[0]);
      return m;
    };
    const Eigen::Matrix2d map = planar(v) * planar(x).inverse();
    const double area = planar(v).determinant() / 2;
    const double expected = area * map.squaredNorm() / 2;
    const StretchWeights weights = stretch_weights(v[0], v[1], v[2], 0);
    if (area < 1e-3) continue; // taken for more
    CHECK(stretch_energy(weights, x[0], x[1], x[2]) == Approx(expected).epsilon(1e-6));
    const double back = area * map.inverse().squaredNorm() / 2;
    if (area < 0.05) continue;
    const double both = stretch_energy(stretch_weights(v[0], v[1], v[2], 0.5), x[0], x[1], x[2]);
    CHECK(both - expected == Approx(0.5 * back).epsilon(1e-6).margin(1e-6 * expected));
  }
}

TEST_CASE("gradient and Hessian of the stretch agree with differences", "[stretch]") {
  std::mt19937 random(2);
  for (const double size : {1.0, 0.1, 1e-3})
    for (const double lambda : {0.0, 0.3})
      for (int repeat = 0; repeat < 20; ++repeat) {
        const auto x = random_triangle(random, size);
        const StretchWeights weights = random_weights(random, lambda);
        std::array<Frame, 3> frames;
        for (int i = 0; i < 3; ++i) frames[i] = tangent_frame(x[i]);
        const StretchDerivatives d = stretch_derivatives(weights, frames);
        const auto at = [&](const Eigen::Matrix<double, 6, 1>& z) {
          return stretch_energy(weights, moved(frames[0], z[0], z[1]), moved(frames[1], z[2], z[3]),
                                moved(frames[2], z[4], z[5]));
        };
        CHECK(d.energy == Approx(at(Eigen::Matrix<double, 6, 1>::Zero())).epsilon(1e-12));
        Eigen::Matrix<double, 6, 1> direction;
        for (int i = 0; i < 3; ++i) direction.segment<2>(2 * i) = random_direction(random).head<2>();
        const double h = 1e-3 * size; // five points: the error is of order h^4
        const auto along = [&](double t) { return at(t * h * direction); };
        const double slope = (8 * (along(1) - along(-1)) - (along(2) - along(-2))) / (12 * h);
        const double bend = (16 * (along(1) + along(-1)) - along(2) - along(-2) - 30 * along(0)) / (12 * h * h);
        CHECK(std::abs(slope - d.gradient.dot(direction)) < 1e-6 * d.gradient.norm());
        CHECK(std::abs(bend - direction.dot(d.hessian * direction)) < 1e-4 * d.hessian.norm());
      }
}

TEST_CASE("a star's energy is the sum of its triangles', and its derivatives theirs", "[stretch]") {
  std::mt19937 random(3);
  for (const double size : {0.5, 1e-2, 1e-5})
    for (int repeat = 0; repeat < 10; ++repeat) {
      const Vec3 x = random_direction(random);
      const Frame frame = tangent_frame(x);
      std::vector<Vec3> ring;
      std::vector<StretchWeights> weights;
      for (int i = 0; i < 7; ++i) {
        const double angle = 0.9 * i;
        ring.push_back(moved(frame, size * std::cos(angle), size * std::sin(angle)));
        weights.push_back(random_weights(random, 0.1));
      }
      Star star;
      star.set(x, ring, weights);
      const auto sum = [&](const Vec3& y) {
        double e = 0;
        for (std::size_t i = 0; i < ring.size(); ++i) e += stretch_energy(weights[i], y, ring[i], ring[(i + 1) % 7]);
        return e;
      };
      const Eigen::Vector2d to(0.2 * size, -0.1 * size);
      CHECK(star.energy(to[0], to[1]) == Approx(sum(star.position(to[0], to[1]))).epsilon(1e-9));
      CHECK((star.coordinates(star.position(to[0], to[1])) - to).norm() < 1e-14);
      Eigen::Vector2d gradient;
      Eigen::Matrix2d hessian;
      CHECK(star.derivatives(gradient, hessian) == Approx(sum(x)).epsilon(1e-9));
      const double h = 1e-3 * size;
      const Eigen::Vector2d d(std::cos(repeat), std::sin(repeat));
      const auto along = [&](double t) { return star.energy(t * h * d[0], t * h * d[1]); };
      CHECK(std::abs((8 * (along(1) - along(-1)) - along(2) + along(-2)) / (12 * h) - gradient.dot(d)) <
            1e-7 * (gradient.norm() + along(0) / size));
      CHECK(std::abs((16 * (along(1) + along(-1)) - along(2) - along(-2) - 30 * along(0)) / (12 * h * h) -
                     d.dot(hessian * d)) < 1e-6 * hessian.norm());
      Eigen::Vector2d step;
      REQUIRE(star.newton_step(step));
      CHECK(star.energy(step[0], step[1]) < star.energy(0, 0));
    }
}

TEST_CASE("the stretch grows without bound where a triangle is about to turn over", "[stretch]") {
  std::mt19937 random(4);
  const std::array<std::array<Vec3, 3>, 4> surfaces = {{
      {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, // right-angled
      {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)}, // on a line
      {Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(1, 0, 0)}, // two corners at one point
      {Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(1, 2, 3)}, // all three
  }};
  for (const auto& v : surfaces)
    for (int repeat = 0; repeat < 5; ++repeat) {
      const auto x = random_triangle(random, 0.3);
      const StretchWeights weights = stretch_weights(v[0], v[1], v[2], 0);
      // The first corner moves to the middle of the side opposite to it.
      const auto at = [&](double t) {
        return stretch_energy(weights, ((1 - t) * x[0] + t * (x[1] + x[2]) / 2).normalized(), x[1], x[2]);
      };
      const double near = at(1 - 1e-6), nearer = at(1 - 1e-9);
      CHECK(near < nearer);
      CHECK(nearer / at(0.9) > 1e10);
      CHECK(std::isinf(at(1.1)));
      CHECK(std::isinf(stretch_energy(weights, x[0], x[2], x[1])));
    }
}

TEST_CASE("the global gradient of the stretch agrees with differences and has no part that turns the sphere",
          "[stretch]") {
  const RawMesh sphere = test::icosphere(2);
  const CanonicalSurface canonical = canonical_surface(manifold(test::scaled(sphere, {1, 2, 0.7})));
  const StretchSum sum(canonical.points, canonical.rings, 0.2);
  std::vector<Vec3> x;
  for (const std::uint32_t v : canonical.original) x.push_back(sphere.vertices[v].normalized());
  std::mt19937 random(5);
  const auto gradient = sum.gradient(x);
  double size = 0;
  Vec3 turning = Vec3::Zero();
  std::vector<Vec3> direction;
  double expected = 0;
  for (std::size_t v = 0; v < x.size(); ++v) {
    CHECK(std::abs(gradient[v].dot(x[v])) < 1e-14);
    size += gradient[v].norm();
    turning += x[v].cross(gradient[v]);
    direction.push_back(x[v].cross(random_direction(random)));
    expected += gradient[v].dot(direction[v]);
  }
  CHECK(turning.norm() < 1e-13 * size);
  const auto along = [&](double t) {
    std::vector<Vec3> y;
    for (std::size_t v = 0; v < x.size(); ++v) y.push_back((x[v] + t * direction[v]).normalized());
    return sum.energy(y);
  };
  const double h = 1e-4;
  CHECK(std::abs((8 * (along(h) - along(-h)) - along(2 * h) + along(-2 * h)) / (12 * h) - expected) < 1e-9 * size);
}

TEST_CASE("undoing the collapses restores the surface", "[stretch]") {
  std::mt19937 random(6);
  std::vector<RawMesh> meshes = {test::box({1, 2, 3}), test::icosphere(3), test::convex_polyhedron(random, 60, 100),
                                 test::tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})};
  if (const auto cow = test::benchmark_cow()) meshes.push_back(cow->mesh());
  for (const RawMesh& mesh : meshes) {
    const CanonicalSurface canonical = canonical_surface(manifold(mesh));
    VertexRings rings(canonical.rings);
    std::vector<std::vector<std::vector<std::uint32_t>>> before; // now and then
    auto steps = collapse_to_tetrahedron(rings, canonical.points);
    REQUIRE(steps.size() == canonical.points.size() - 4);
    std::size_t left = 0;
    for (std::uint32_t v = 0; v < rings.size(); ++v)
      if (!rings.of(v).empty()) {
        ++left;
        CHECK(rings.of(v).size() == 3);
      }
    CHECK(left == 4);
    while (!steps.empty()) {
      rings.undo(std::move(steps.back()));
      steps.pop_back();
    }
    bool same = true;
    for (std::uint32_t v = 0; v < rings.size(); ++v) same = same && from_smallest(rings.of(v)) == canonical.rings[v];
    CHECK(same);
  }
}

TEST_CASE("every collapse leaves a triangulated sphere", "[stretch]") {
  const CanonicalSurface canonical = canonical_surface(manifold(test::icosphere(2)));
  VertexRings all(canonical.rings), rings(canonical.rings);
  for (const Collapse& step : collapse_to_tetrahedron(all, canonical.points)) {
    REQUIRE(rings.link_condition(step.vertex, step.ring[0]));
    rings.collapse(step.vertex, step.ring[0]);
    std::size_t vertices = 0, sides = 0;
    bool mutual = true;
    for (std::uint32_t v = 0; v < rings.size(); ++v) {
      const auto ring = rings.of(v);
      vertices += !ring.empty();
      sides += ring.size();
      for (std::size_t i = 0; i < ring.size(); ++i) { // the face (v, a, b) is also in the ring of a, as (b, v)
        const auto other = rings.of(ring[i]);
        const auto b = std::find(other.begin(), other.end(), ring[(i + 1) % ring.size()]) - other.begin();
        mutual = mutual && std::size_t(b) < other.size() && other[std::size_t(b + 1) % other.size()] == v;
      }
    }
    CHECK(mutual);
    CHECK(sides / 2 == 3 * vertices - 6);
  }
}

TEST_CASE("the link condition refuses an edge of a triangle that is no face", "[stretch]") {
  // Two tetrahedra joined at the triangle 0 1 2, which is no face.
  const VertexRings rings({{1, 3, 2, 4}, {2, 3, 0, 4}, {0, 3, 1, 4}, {0, 1, 2}, {0, 2, 1}});
  CHECK_FALSE(rings.link_condition(0, 1));
  CHECK_FALSE(rings.link_condition(2, 1));
  CHECK(rings.link_condition(3, 0));
  CHECK(rings.link_condition(0, 4));
}
