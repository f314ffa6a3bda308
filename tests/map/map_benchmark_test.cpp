// The benchmark cow's maps to the sphere: what the paper's recipe gives, and the flipped triangles of each method.
#include "host/map/harmonic.hpp"
#include "host/map/quality.hpp"
#include "host/map/smooth.hpp"
#include "host/paper/recipe.hpp"
#include "host/sphere_grid.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

/// The point of the surface that a map sends to the direction: on the ray through the chord triangles.
Vec3 looked_up(const ManifoldSurface& surface, const SphereMap& map, const Vec3& direction) {
  for (const Face& f : surface.faces()) {
    const Vec3 &a = map.positions[f[0]], &b = map.positions[f[1]], &c = map.positions[f[2]];
    if (direction.dot(a) < 0 && direction.dot(b) < 0 && direction.dot(c) < 0) continue;
    const Vec3 weights(direction.dot(b.cross(c)), direction.dot(c.cross(a)), direction.dot(a.cross(b)));
    if (weights.minCoeff() < -1e-15) continue;
    const auto& v = surface.vertices();
    return (weights[0] * v[f[0]] + weights[1] * v[f[1]] + weights[2] * v[f[2]]) / weights.sum();
  }
  FAIL("no triangle in a direction");
  return Vec3::Zero();
}

} // namespace

TEST_CASE("the paper's recipe deletes vertex 408 and lays the benchmark cow out from vertex 406",
          "[harmonic][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto surface = ManifoldSurface::from(*cow);
  CHECK(pole_vertex(surface, {}) == 408);
  const SphereMap map = harmonic_map(surface, paper::harmonic_map());
  CHECK(map.positions[408] == Vec3(0, 0, -1));
  // The circle of radius 10, in the order of recipes: azimuths grow.
  double before = -1;
  for (const int v : {406, 410, 510, 509, 508, 507, 1589, 1590, 1494, 407}) {
    const Vec3& p = map.positions[std::size_t(v)];
    CHECK(p.z() == Approx(-99.0 / 101).epsilon(1e-15));
    double azimuth = std::atan2(p.y(), p.x());
    if (azimuth < 0) azimuth += 2 * std::numbers::pi;
    CHECK(azimuth > before);
    before = azimuth;
  }
  CHECK(map.positions[406].y() == 0);
  CHECK(map.positions[406].x() == Approx(20.0 / 101).epsilon(1e-15));
}

TEST_CASE("the paper's recipe gives the paper's radial coefficients", "[harmonic][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto surface = ManifoldSurface::from(*cow);
  const SphereMap map = harmonic_map(surface, paper::harmonic_map());
  struct Row {
    int l, m;
    std::complex<double> paper;
  };
  const Row rows[] = {{1, 0, -0.0996},
                      {1, 1, 0.0237},
                      {2, 0, 0.0106},
                      {2, 1, {0.0193, 0.0061}},
                      {2, 2, {0.0591, 0.0193}},
                      {3, 0, 0.0005},
                      {3, 1, {-0.0020, 0.0003}},
                      {3, 2, {-0.0358, -0.0127}},
                      {3, 3, {-0.0083, -0.0094}}};
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 63);
  std::complex<double> sums[std::size(rows)] = {};
  double monopole = 0;
  for (int i = 0; i < grid.rings; ++i)
    for (int j = 0; j < grid.ring_length; ++j) {
      const double theta = grid.theta[std::size_t(i)], phi = grid.phi(j);
      const Vec3 direction(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      const double weight = grid.weights[std::size_t(i)] * 2 * std::numbers::pi / grid.ring_length;
      const double radius = looked_up(surface, map, direction).norm();
      monopole += weight * radius / std::sqrt(4 * std::numbers::pi);
      for (std::size_t k = 0; k < std::size(rows); ++k) {
        const auto [l, m, paper] = rows[k];
        const double y = std::sph_legendre(unsigned(l), unsigned(m), theta); // with the Condon-Shortley phase
        sums[k] += weight * radius * y * std::polar(1.0, -m * phi);
      }
    }
  CHECK(std::abs(monopole - 0.5825) < 2e-4);
  double off = 0, size = 0;
  for (std::size_t k = 0; k < std::size(rows); ++k) {
    const double count = rows[k].m > 0 ? 2 : 1;
    UNSCOPED_INFO(rows[k].l << " " << rows[k].m << ": " << sums[k] << " paper " << rows[k].paper);
    off += count * std::norm(sums[k] - rows[k].paper);
    size += count * std::norm(rows[k].paper);
  }
  CHECK(std::sqrt(off / size) < 0.003);
}

TEST_CASE("the benchmark cow's flipped triangles: 68 cotangent, 1 mean value, none Tutte",
          "[harmonic][quality][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto surface = ManifoldSurface::from(*cow);
  struct Case {
    EdgeWeights weights;
    bool centre;
    std::size_t flipped;
    double smallest_area;
    std::size_t unseen;
  };
  for (const Case& c :
       {Case{EdgeWeights::cotangent, false, 68, 1.6e-27, 0},                                                   //
        Case{EdgeWeights::cotangent, true, 68, 6.8e-27, 2768}, Case{EdgeWeights::mean_value, false, 0, 0, 0},  //
        Case{EdgeWeights::mean_value, true, 1, 1.5e-17, 2776}, Case{EdgeWeights::tutte, false, 0, 8.5e-11, 0}, //
        Case{EdgeWeights::tutte, true, 0, 4.5e-11, 1929}}) {
    HarmonicOptions options;
    options.weights = c.weights;
    options.centre = c.centre;
    options.polish = false;
    const MapQuality quality = judge(surface, harmonic_map(surface, options), 512);
    UNSCOPED_INFO(name(c.weights) << (c.centre ? " centred" : "") << ": smallest " << quality.smallest_area);
    CHECK(quality.flipped.size() == c.flipped);
    CHECK(quality.flat.empty());
    CHECK(std::abs(quality.degree - 1) < 4e-14);
    if (c.smallest_area > 0) CHECK(quality.smallest_area == Approx(c.smallest_area).epsilon(0.05));
    if (c.unseen > 0) CHECK(quality.unseen == c.unseen);
  }
}

TEST_CASE("the polished map of the benchmark cow is the same from every pole", "[harmonic][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto surface = ManifoldSurface::from(*cow);
  SphereMap first;
  double plain_apart = 0;
  for (std::uint32_t k = 0; k < 20; ++k) {
    HarmonicOptions options;
    options.pole.rule = Pole::Rule::vertex;
    options.pole.vertex = (408 + 137 * k) % std::uint32_t(surface.vertices().size());
    options.polish = true;
    const SphereMap map = harmonic_map(surface, options);
    if (k == 0) first = map;
    double worst = 0;
    for (std::size_t i = 0; i < map.positions.size(); ++i)
      worst = std::max(worst, (map.positions[i] - first.positions[i]).norm());
    check_at_most(worst, 7e-12, fmt::format("pole {}", options.pole.vertex));
    CHECK(judge(surface, map, 512).flipped.size() == 68);
    options.polish = false;
    options.centre = true;
    plain_apart = std::max(plain_apart, (harmonic_map(surface, options).positions[0] - first.positions[0]).norm());
  }
  CHECK(plain_apart > 0.05); // without polish it is another map each time
}

TEST_CASE("mean-curvature flow flips what cotangent weights flip on the benchmark cow", "[smooth][benchmark]") {
  const auto cow = benchmark_cow();
  if (!cow) return skip_without_cow();
  const auto surface = ManifoldSurface::from(*cow);
  const MapQuality quality = judge(surface, smooth_map(surface), 512);
  CHECK(quality.flipped.size() == 68);
  CHECK(std::abs(quality.degree - 1) < 4e-14);
}
