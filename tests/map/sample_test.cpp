#include "host/error.hpp"
#include "host/map/closest_point.hpp"
#include "host/map/sample_fields.hpp"
#include "host/sphere_directions.hpp"
#include "tests/support/compare_samples.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

const std::vector<GridKind> kinds = {GridKind::gauss_legendre, GridKind::clenshaw_curtis, GridKind::driscoll_healy,
                                     GridKind::driscoll_healy_square, GridKind::fejer};

void compare_everywhere(const MappedMesh& map, double figure) {
  Paths paths;
  for (const GridKind kind : kinds)
    for (const int lmax : {0, 1, 7, 31}) CHECK(compare_samples(paths, map, make_grid(kind, lmax), figure));
}

// Of the spherical triangle: A. Van Oosterom and J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125.
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 2 * std::atan2(a.dot(b.cross(c)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

std::string refusal(const MappedMesh& map, Fault fault) {
  std::string words;
  Paths paths;
  paths.each([&](Backend& backend) {
    try {
      sample(backend, map, make_grid(GridKind::gauss_legendre, 7));
      FAIL("not refused");
    } catch (const Error& error) {
      CHECK(error.fault() == fault);
      words = error.what();
    }
  });
  return words;
}

} // namespace

TEST_CASE("directions of a grid have exact zeros and the symmetry of the octants", "[sample]") {
  for (const int n : {1, 2, 4, 5, 8, 12, 60, 1026, 2160}) {
    INFO(n);
    const SphereDirections directions(make_grid(GridKind::gauss_legendre, 3, n));
    for (int j = 0; j < n; ++j) {
      const auto at = std::size_t(j), mirror = std::size_t((n - j) % n);
      const long double phi = 2 * std::numbers::pi_v<long double> * j / n;
      CHECK(std::abs(directions.cosine_phi[at] - double(std::cos(phi))) <= 0x1p-53);
      CHECK(std::abs(directions.sine_phi[at] - double(std::sin(phi))) <= 0x1p-53);
      CHECK(directions.cosine_phi[at] == directions.cosine_phi[mirror]);
      CHECK(directions.sine_phi[at] == -directions.sine_phi[mirror]);
      if (n % 4 == 0) {
        const auto quarter = std::size_t((j + n / 4) % n);
        CHECK(directions.cosine_phi[quarter] == -directions.sine_phi[at]);
        CHECK(directions.sine_phi[quarter] == directions.cosine_phi[at]);
      }
    }
    CHECK(directions(1, 0) == Vec3(1, 0, 0));
  }
}

TEST_CASE("every path finds the reference's triangle in every direction on maps without flips", "[sample]") {
  for (const int level : {0, 1, 3}) compare_everywhere(identity_map(level), 1e-15);
  compare_everywhere(rotated_map(2, 1), 1e-15);
  compare_everywhere(warped_map(3, 0.02, 5), 1e-15);
  compare_everywhere(tetrahedron_map(), 1e-15);
}

TEST_CASE("every path finds the reference's triangle where directions lie on edges and vertices", "[sample]") {
  compare_everywhere(octahedron_map(), 1e-15);
  compare_everywhere(flat_triangle_map(), 1e-15);
  Paths paths;
  for (const GridKind kind : kinds)
    for (const int lmax : {1, 3, 7}) {
      const SphereGrid grid = make_grid(kind, lmax);
      if (grid.ring_length < 3) continue;
      const MappedMesh map = grid_map(grid);
      CHECK(compare_samples(paths, map, grid, 1e-15));
      CHECK(compare_samples(paths, map, make_grid(GridKind::clenshaw_curtis, 14), 1e-15));
    }
}

TEST_CASE("every path finds the reference's triangle on folded and random maps", "[sample]") {
  for (const double size : {0.1, 0.3, 1.0}) compare_everywhere(warped_map(3, size, 11), 2.5e-14);
  compare_everywhere(random_map(1, 4), 2.5e-14);
  compare_everywhere(random_map(2, 9), 2.5e-14);
}

TEST_CASE("every path finds the reference's triangle among triangles far smaller than a cell", "[sample]") {
  for (const double power : {3.0, 8.0, 18.0}) compare_everywhere(crowded_map(3, power), 3e-15);
}

TEST_CASE("a map turned inside out is flipped everywhere and hit as well", "[sample]") {
  MappedMesh map = rotated_map(2, 8);
  for (Face& f : map.faces) std::swap(f[0], f[1]);
  map.name = "inside out";
  compare_everywhere(map, 1e-15);
}

TEST_CASE("faces with two corners at one place are never hit and leave no gap", "[sample]") {
  MappedMesh map = rotated_map(2, 2);
  map.name = "collapsed edges";
  for (std::size_t f = 0; f < map.faces.size(); f += 40)
    map.positions[map.faces[f][0]] = map.positions[map.faces[f][1]];
  compare_everywhere(map, 1e-15);
}

TEST_CASE("a direction on shared edges and corners goes to the lowest face that is not flipped", "[sample]") {
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, 1);
  const MappedMesh map = octahedron_map();
  MappedMesh twice = map; // flipped faces first
  for (Face& f : twice.faces) std::swap(f[1], f[2]);
  twice.faces.insert(twice.faces.end(), map.faces.begin(), map.faces.end());
  Paths paths;
  paths.each([&](Backend& backend) {
    const SphereSamples samples = sample(backend, map, grid);
    const auto n = std::size_t(grid.ring_length);
    CHECK(samples.faces[0] == 0);
    CHECK(samples.faces[n] == 0); // (1, 0, 0)
    CHECK(samples.faces[2 * n] == 4);
    CHECK(samples.edge_points == 3 * n);
    CHECK(samples.folded_points == 0);
    const SphereSamples again = sample(backend, twice, grid);
    CHECK(again.flipped_points == 0);
    CHECK(again.flipped_faces == 8);
    for (std::size_t p = 0; p < samples.points(); ++p) CHECK(again.faces[p] == samples.faces[p] + 8);
  });
}

TEST_CASE("a direction that no triangle holds is an error with the direction", "[sample]") {
  MappedMesh map = rotated_map(1, 7);
  map.faces.erase(map.faces.begin() + 17);
  const std::string words = refusal(map, Fault::map_failed);
  CHECK(words.find("no triangle of the map lies in the direction (") != std::string::npos);
  CHECK(words.find("degrees, ring ") != std::string::npos);
  CHECK(words.find("try another method") != std::string::npos);
  map.faces.clear();
  CHECK(refusal(map, Fault::map_failed).find("nor in 119 others") != std::string::npos);
}

TEST_CASE("positions off the sphere and faces of other meshes are refused", "[sample]") {
  MappedMesh map = identity_map(0);
  map.positions[4] *= 1 + 1e-8;
  CHECK(refusal(map, Fault::bad_argument).find("vertex 4 ") != std::string::npos);
  map.positions[4] = Vec3(NAN, 0, 1);
  CHECK(refusal(map, Fault::bad_argument).find("not on the unit sphere") != std::string::npos);
  map = identity_map(0);
  map.faces[5][1] = 12;
  CHECK(refusal(map, Fault::bad_argument).find("face 5 names vertex 12") != std::string::npos);
  map = identity_map(0);
  map.positions.push_back(Vec3::Zero()); // of no face
  Paths paths;
  paths.each(
      [&](Backend& backend) { CHECK(sample(backend, map, make_grid(GridKind::gauss_legendre, 15)).faces_hit == 20); });
}

TEST_CASE("quadrature weights of the points of a triangle add up to its solid angle", "[sample]") {
  Paths paths;
  const MappedMesh map = warped_map(1, 0.08, 21);
  paths.each([&](Backend& backend) {
    double last = 1;
    for (const int lmax : {31, 127, 511}) {
      const SphereGrid grid = make_grid(GridKind::gauss_legendre, lmax);
      const SphereSamples samples = sample(backend, map, grid);
      std::vector<double> sums(map.faces.size(), 0.0);
      for (std::size_t p = 0; p < samples.points(); ++p)
        sums[samples.faces[p]] +=
            grid.weights[p / std::size_t(grid.ring_length)] * 2 * std::numbers::pi / grid.ring_length;
      double worst = 0;
      for (std::size_t f = 0; f < map.faces.size(); ++f) {
        const Face& t = map.faces[f];
        worst = std::max(
            worst, std::abs(sums[f] - solid_angle(map.positions[t[0]], map.positions[t[1]], map.positions[t[2]])));
      }
      check_at_most(worst, last / 3, fmt::format("lmax {}", lmax));
      last = worst;
    }
    check_at_most(last, 1e-3, "511");
  });
}

TEST_CASE("positions interpolated on the map itself point in the direction sampled", "[sample]") {
  const SphereGrid grid = make_grid(GridKind::driscoll_healy, 20);
  const SphereDirections directions(grid);
  const MappedMesh map = warped_map(3, 0.3, 2);
  Paths paths;
  paths.each([&](Backend& backend) {
    const SphereSamples samples = sample(backend, map, grid);
    const std::vector<double> xyz = sample_positions(samples, map.faces, map.positions);
    std::vector<double> vertex_fields;
    for (int k = 0; k < 3; ++k)
      for (const Vec3& p : map.positions) vertex_fields.push_back(p[k]);
    CHECK(sample_fields(samples, map.faces, vertex_fields, map.positions.size()) == xyz);
    double worst = 0;
    for (std::size_t p = 0; p < samples.points(); ++p) {
      const Vec3 d = directions(int(p) / grid.ring_length, int(p) % grid.ring_length);
      const Vec3 at(xyz[p], xyz[samples.points() + p], xyz[2 * samples.points() + p]);
      worst = std::max(worst, (at.normalized() - d).norm());
    }
    check_at_most(worst, 1e-15, "direction");
  });
}

TEST_CASE("more directions than expected left open by the filter are decided all the same", "[sample]") {
  // 320 triangles meet at each pole, and the grid has 320 points there.
  const MappedMesh map = grid_map(make_grid(GridKind::gauss_legendre, 150));
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, 150);
  REQUIRE(std::size_t(grid.ring_length) * std::size_t(grid.ring_length) > 65536);
  const SphereSamples truth = sample(*make_cpu_backend(), map, grid);
  Paths paths;
  paths.each([&](Backend& backend) {
    const SphereSamples found = sample(backend, map, grid);
    CHECK(found.faces == truth.faces);
    CHECK(found.weights == truth.weights);
    CHECK(found.edge_points == truth.edge_points);
    CHECK(found.edge_points >= 640);
  });
}

TEST_CASE("the memory announced for sampling covers the result", "[sample]") {
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 200);
  Paths paths;
  paths.each([&](Backend& backend) {
    const MemoryNeed need = backend.sphere_sampler(grid)->memory(5000);
    CHECK(need.host > 28 * grid.points());
    CHECK((need.device > 28 * grid.points()) == (backend.facts().type != "cpu"));
  });
}

TEST_CASE("fields that do not fit the mesh are refused", "[sample]") {
  const MappedMesh map = identity_map(0);
  const SphereSamples samples = sample(*make_cpu_backend(), map, make_grid(GridKind::gauss_legendre, 7));
  const std::vector<double> values(25, 1.0);
  const auto fault = [](const auto& call) {
    try {
      (void)call();
    } catch (const Error& error) {
      return error.fault();
    }
    return Fault::interrupted;
  };
  CHECK(fault([&] { return sample_fields(samples, map.faces, values, 12); }) == Fault::bad_argument);
  CHECK(fault([&] { return sample_fields(samples, map.faces, {}, 0); }) == Fault::bad_argument);
  CHECK(fault([&] {
          return sample_fields(samples, std::span(map.faces).first(10), std::span(values).first(24), 12);
        }) == Fault::bad_argument);
  CHECK(fault([&] { return sample_fields(samples, map.faces, std::span(values).first(22), 11); }) ==
        Fault::bad_argument);
  const std::vector<double> ones = sample_fields(samples, map.faces, std::span(values).first(24), 12);
  CHECK(ones.size() == 2 * samples.points());
  for (const double one : ones) CHECK(std::abs(one - 1) <= 4e-16);
}

TEST_CASE("the same map gives the same bits on any number of threads and again", "[sample]") {
  const MappedMesh map = warped_map(4, 0.05, 13);
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 100);
  const auto one = make_cpu_backend(1);
  const SphereSamples truth = sample(*one, map, grid);
  const auto same = [&](const SphereSamples& other) {
    CHECK(other.faces == truth.faces);
    CHECK(other.weights == truth.weights);
    CHECK(other.folded_points == truth.folded_points);
    CHECK(other.faces_hit == truth.faces_hit);
  };
  for (const unsigned threads : {2U, 7U}) same(sample(*make_cpu_backend(threads), map, grid));
  Paths paths;
  paths.each([&](Backend& backend) {
    for (int i = 0; i < 2; ++i) same(sample(backend, map, grid));
  });
}

TEST_CASE("both paths find the same places on 1025 rings, on even, folded and crowded maps", "[sample]") {
  Paths paths;
  for (const MappedMesh& map : {warped_map(3, 0.02, 5), warped_map(3, 0.3, 11), crowded_map(3, 12), octahedron_map()})
    for (const int lmax : {13, 1024}) {
      INFO(map.name << ", lmax " << lmax);
      const SphereGrid grid = make_grid(GridKind::gauss_legendre, lmax);
      SphereSamples first;
      paths.each([&](Backend& backend) {
        INFO(backend.facts().name);
        SphereSamples found = sample(backend, map, grid);
        CHECK(found.points() == grid.points());
        CHECK(found.exact_decisions < grid.points() / 10); // most on the octahedron, its edges on the grid
        if (first.faces.empty())
          first = std::move(found);
        else
          CHECK((found.faces == first.faces && found.weights == first.weights));
      });
    }
}

TEST_CASE("sampling stops when asked", "[sample]") {
  struct Impatient final : Monitor {
    bool stopped() const override { return true; }
  } impatient;
  const MappedMesh map = identity_map(2);
  Paths paths;
  paths.each([&](Backend& backend) {
    try {
      (void)backend.sphere_sampler(make_grid(GridKind::gauss_legendre, 31))
          ->sample(map.positions, map.faces, impatient);
      FAIL("not stopped");
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::interrupted);
    }
  });
}

TEST_CASE("the closest point is nearer than any other point of the map", "[sample][closest]") {
  const SphereGrid grid = make_grid(GridKind::clenshaw_curtis, 9);
  const SphereDirections directions(grid);
  Monitor silent;
  for (const MappedMesh& map :
       {warped_map(2, 0.02, 1), warped_map(2, 0.6, 1), crowded_map(2, 1e-3), flat_triangle_map()}) {
    INFO(map.name);
    const SphereSamples samples = closest_samples(map.positions, map.faces, grid, silent);
    const std::vector<double> xyz = sample_positions(samples, map.faces, map.positions);
    const std::size_t n = samples.points();
    std::mt19937 random(3);
    double worst = 0;
    for (std::size_t p = 0; p < n; ++p) {
      const Vec3 d = directions(int(p) / grid.ring_length, int(p) % grid.ring_length);
      const double distance = (Vec3(xyz[p], xyz[n + p], xyz[2 * n + p]) - d).norm();
      for (const Face& f : map.faces)
        for (int k = 0; k < 6; ++k) {
          double u = double(random()) / 4294967296.0, v = double(random()) / 4294967296.0;
          if (u + v > 1) u = 1 - u, v = 1 - v;
          if (k == 0) u = 0; // an edge
          if (k == 1) u = v = 0;
          const Vec3 q = (1 - u - v) * map.positions[f[0]] + u * map.positions[f[1]] + v * map.positions[f[2]];
          worst = std::max(worst, distance - (q - d).norm());
        }
    }
    check_at_most(worst, 1e-15, "nearer by");
  }
}

TEST_CASE("on a fine map without flips the closest point and the ray find the same place", "[sample][closest]") {
  const SphereGrid grid = make_grid(GridKind::gauss_legendre, 15);
  const MappedMesh map = rotated_map(4, 5);
  Monitor silent;
  const SphereSamples closest = closest_samples(map.positions, map.faces, grid, silent);
  const SphereSamples ray = sample(*make_cpu_backend(), map, grid);
  const auto a = sample_positions(closest, map.faces, map.positions),
             b = sample_positions(ray, map.faces, map.positions);
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  check_at_most(worst, 8e-5, "places");
  CHECK(closest.flipped_faces == 0);
  CHECK(closest.faces_hit > 300);
}
