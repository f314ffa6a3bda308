#include "host/error.hpp"
#include "host/geometry/orientation.hpp"
#include "host/map/stretch.hpp"
#include "host/map/stretch_repeats.hpp"
#include "host/mesh/subdivide.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

using namespace cowgpu;

namespace {

ManifoldSurface manifold(RawMesh mesh) {
  return ManifoldSurface::from(ClosedSurface::from(std::move(mesh)));
}

SphereMap mapped(const ManifoldSurface& surface, const StretchOptions& options = {}) {
  Monitor monitor;
  return stretch_map(surface, options, monitor);
}

std::size_t flips(const ManifoldSurface& surface, const SphereMap& map) {
  std::size_t count = 0;
  for (const Face& f : surface.faces())
    if (orientation(map.positions[f[0]], map.positions[f[1]], map.positions[f[2]]) <= 0) ++count;
  return count;
}

// Positively oriented triangles that wind round the sphere once cover each direction once.
double covered(const ManifoldSurface& surface, const SphereMap& map) {
  double sum = 0;
  for (const Face& f : surface.faces()) {
    const Vec3 &a = map.positions[f[0]], &b = map.positions[f[1]], &c = map.positions[f[2]];
    sum += 2 * std::atan2(a.dot((b - a).cross(c - a)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
  }
  return sum / (4 * std::numbers::pi);
}

void check_bijective(const ManifoldSurface& surface, const SphereMap& map) {
  CHECK(flips(surface, map) == 0);
  CHECK(std::abs(covered(surface, map) - 1) < 1e-11);
  double off = 0;
  for (const Vec3& x : map.positions)
    if (!x.isZero(0)) off = std::max(off, std::abs(x.norm() - 1));
  CHECK(off < 1e-15);
}

Eigen::Matrix3d turn(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized().matrix();
}

struct Renumbered {
  RawMesh mesh;
  std::vector<std::uint32_t> to; // vertex v became to[v]
};

Renumbered renumbered(const RawMesh& mesh, std::uint32_t seed) {
  std::mt19937 random(seed);
  Renumbered result{mesh, std::vector<std::uint32_t>(mesh.vertices.size())};
  std::iota(result.to.begin(), result.to.end(), 0U);
  std::shuffle(result.to.begin(), result.to.end(), random);
  for (std::size_t v = 0; v < result.to.size(); ++v) result.mesh.vertices[result.to[v]] = mesh.vertices[v];
  for (Face& f : result.mesh.faces) {
    for (std::uint32_t& corner : f) corner = result.to[corner];
    std::rotate(f.begin(), f.begin() + random() % 3, f.end());
  }
  std::shuffle(result.mesh.faces.begin(), result.mesh.faces.end(), random);
  return result;
}

double size_of(const RawMesh& mesh) {
  Vec3 low = mesh.vertices[0], high = low;
  for (const Vec3& v : mesh.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
  return (high - low).norm();
}

// Renumbered, turned, scaled, far from the origin, reflected: all of it must give a map without flips.
void check_poses(const RawMesh& mesh) {
  const double size = size_of(mesh);
  const RawMesh turned = test::shuffled(test::rotated(mesh, turn(1)), 1);
  const std::vector<RawMesh> poses = {turned, test::scaled(turned, Vec3::Constant(1e6 / size)),
                                      test::translated(test::shuffled(mesh, 2), size * Vec3(3e5, -2e5, 1e5)),
                                      test::flipped(test::scaled(mesh, {-1, 1, 1}))};
  for (std::size_t pose = 0; pose < poses.size(); ++pose) {
    INFO(mesh.name << ", pose " << pose);
    const ManifoldSurface surface = manifold(poses[pose]);
    check_bijective(surface, mapped(surface));
  }
}

double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0;
  for (std::size_t v = 0; v < a.size(); ++v) largest = std::max(largest, (a[v] - b[v]).norm());
  return largest;
}

Fault fault_of(const RawMesh& mesh, const StretchOptions& options = {}) {
  const ManifoldSurface surface = manifold(mesh);
  try {
    mapped(surface, options);
  } catch (const Error& error) {
    CHECK(std::string(error.what()).size() > 40);
    return error.fault();
  }
  FAIL("nothing was thrown");
  return {};
}

// Two cones on a polygon of n corners.
RawMesh bipyramid(std::uint32_t n) {
  RawMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    mesh.vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
    mesh.faces.push_back({i, (i + 1) % n, n});
    mesh.faces.push_back({(i + 1) % n, i, n + 1});
  }
  mesh.vertices.emplace_back(0, 0, 1);
  mesh.vertices.emplace_back(0, 0, -1);
  return mesh;
}

} // namespace

TEST_CASE("the stretch map of the benchmark has no flips, and the energy and height of the sweeps", "[stretch]") {
  const auto cow = test::benchmark_cow();
  if (!cow) return test::skip_without_cow();
  const ManifoldSurface surface = ManifoldSurface::from(*cow);
  const SphereMap map = mapped(surface);
  check_bijective(surface, map);
  CHECK(map.method == MapMethod::stretch);
  REQUIRE(map.notes.size() == 2);
  CHECK_THAT(map.notes[0], Catch::Matchers::Contains("relaxed 30 times"));
  CHECK_THAT(map.notes[1], Catch::Matchers::Contains("mean squared stretch 2.2"));
  const StretchMeasure measure = measure_stretch(surface, map);
  CHECK(measure.energy < 2.25); // 2.225
  double height = 1;
  for (const Face& f : surface.faces()) {
    const Vec3 &a = map.positions[f[0]], &b = map.positions[f[1]], &c = map.positions[f[2]];
    height = std::min(height, (b - a).cross(c - a).norm() / std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}));
  }
  CHECK(height > 5e-4); // 1.9e-3

  const StretchMeasure later = measure_stretch(surface, mapped(surface, {300, 0, false}));
  CHECK(later.energy < measure.energy);
  CHECK(measure_stretch(surface, mapped(surface, {0, 0, false})).energy > measure.energy);
}

TEST_CASE("the bodies of libcgal-demo have stretch maps without flips", "[stretch]") {
  for (const std::string& name : test::demo_bodies) {
    const auto body = test::demo_body(name);
    if (!body) {
      test::skip_without_bodies(name);
      continue;
    }
    INFO(name);
    const ManifoldSurface surface = ManifoldSurface::from(*body);
    check_bijective(surface, mapped(surface));
  }
}

TEST_CASE("stretch maps have no flips in any order and pose", "[stretch]") {
  const auto cow = test::benchmark_cow();
  if (cow)
    check_poses(cow->mesh());
  else
    test::skip_without_cow();
  for (const char* name : {"bull", "homer", "triceratops"}) {
    if (const auto body = test::demo_body(name))
      check_poses(body->mesh());
    else
      test::skip_without_bodies(name);
  }
}

TEST_CASE("stretch maps of the larger bodies have no flips in any order and pose", "[stretch][long]") {
  for (const char* name : {"armadillo", "bear", "bunny00", "camel", "diplodocus"}) {
    if (const auto body = test::demo_body(name))
      check_poses(body->mesh());
    else
      test::skip_without_bodies(name);
  }
}

TEST_CASE("a stretch map is the same bits again, and for a renumbered mesh", "[stretch]") {
  const auto cow = test::benchmark_cow();
  const RawMesh mesh = cow ? cow->mesh() : test::scaled(test::icosphere(3), {1, 2, 0.6});
  const SphereMap map = mapped(manifold(mesh));
  CHECK(mapped(manifold(mesh)).positions == map.positions);
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const Renumbered other = renumbered(mesh, seed);
    const SphereMap again = mapped(manifold(other.mesh));
    bool same = true;
    for (std::size_t v = 0; v < other.to.size(); ++v) same = same && again.positions[other.to[v]] == map.positions[v];
    CHECK(same);
  }
}

TEST_CASE("the stretch map of a turned, scaled and shifted body is turned with it", "[stretch]") {
  const auto cow = test::benchmark_cow();
  if (!cow) return test::skip_without_cow();
  const SphereMap map = mapped(ManifoldSurface::from(*cow));
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Eigen::Matrix3d rotation = turn(seed);
    RawMesh mesh = test::scaled(test::rotated(cow->mesh(), rotation), Vec3::Constant(std::pow(17.0, seed)));
    mesh = test::translated(mesh, 50 * size_of(mesh) * Vec3(1, 2, -3));
    SphereMap turned = mapped(manifold(mesh));
    for (Vec3& x : turned.positions) x = (rotation.transpose() * x).eval();
    CHECK(largest_distance(turned.positions, map.positions) < 1e-6);
  }
}

TEST_CASE("the stretch map of a reflected body is reflected with it", "[stretch]") {
  const auto cow = test::benchmark_cow();
  if (!cow) return test::skip_without_cow();
  const SphereMap map = mapped(ManifoldSurface::from(*cow));
  SphereMap reflected = mapped(manifold(test::flipped(test::scaled(cow->mesh(), {-1, 1, 1}))));
  for (Vec3& x : reflected.positions) x[0] = -x[0];
  CHECK(largest_distance(reflected.positions, map.positions) < 1e-6);
}

TEST_CASE("converged stretch maps of the benchmark are one minimum, whatever its order", "[stretch]") {
  const auto cow = test::benchmark_cow();
  if (!cow) return test::skip_without_cow();
  const ManifoldSurface surface = ManifoldSurface::from(*cow);
  const SphereMap map = mapped(surface, {30, 0, true});
  check_bijective(surface, map);
  const StretchMeasure measure = measure_stretch(surface, map);
  CHECK(measure.energy < 2.14);
  CHECK(measure.gradient < 1e-6);
  REQUIRE(map.notes.size() == 3);
  CHECK_THAT(map.notes[1], Catch::Matchers::StartsWith("converged after "));

  const Eigen::Matrix3d rotation = turn(9);
  const Renumbered other = renumbered(test::rotated(cow->mesh(), rotation), 9);
  const SphereMap again = mapped(manifold(other.mesh), {30, 0, true});
  double largest = 0;
  for (std::size_t v = 0; v < other.to.size(); ++v)
    largest = std::max(largest, (rotation.transpose() * again.positions[other.to[v]] - map.positions[v]).norm());
  CHECK(largest < 1e-5);
}

namespace {

void check_copies_of_the_benchmark(std::size_t copies) {
  const auto cow = test::benchmark_cow();
  if (!cow) return test::skip_without_cow();
  const ManifoldSurface surface = ManifoldSurface::from(*cow);
  const StretchOptions options{30, 0, true};
  Monitor monitor;
  const auto repeats = repeat_stretch_map(surface, mapped(surface, options), options, int(copies), 0, monitor);
  REQUIRE(repeats.size() == copies);
  for (const StretchRepeat& repeat : repeats) {
    INFO("seed " << repeat.seed);
    CHECK(repeat.reached);
    CHECK(repeat.largest < 1e-6); // 2e-8
    CHECK(repeat.rms <= repeat.largest);
    CHECK(repeat.rms > 0);
  }
}

} // namespace

TEST_CASE("relabelled and turned copies of the benchmark reach one minimum", "[stretch]") {
  check_copies_of_the_benchmark(2);
}

TEST_CASE("ten relabelled and turned copies of the benchmark reach one minimum", "[stretch][long]") {
  check_copies_of_the_benchmark(10);
}

TEST_CASE("copies do not reach the energy of another map", "[stretch]") {
  const ManifoldSurface surface = manifold(test::scaled(test::icosphere(2), {1, 2, 3}));
  Monitor monitor;
  const auto repeats = repeat_stretch_map(surface, mapped(surface, {0, 0, false}), {30, 0, true}, 3, 2, monitor);
  for (const StretchRepeat& repeat : repeats) {
    CHECK_FALSE(repeat.reached);
    CHECK(repeat.largest > 1e-3);
  }
  CHECK(repeat_stretch_map(surface, mapped(surface), {}, 0, 0, monitor).empty());
}

TEST_CASE("a sphere maps to itself", "[stretch]") {
  for (const int level : {2, 3, 4}) {
    const RawMesh sphere = test::icosphere(level, 7);
    const ManifoldSurface surface = manifold(test::translated(sphere, {1, 2, 3}));
    const SphereMap map = mapped(surface, {30, 0, true});
    check_bijective(surface, map);
    std::vector<Vec3> expected;
    for (const Vec3& v : sphere.vertices) expected.push_back(v / 7);
    INFO("level " << level);
    CHECK(measure_stretch(surface, map).energy <=
          measure_stretch(surface, {MapMethod::file, expected, {}}).energy + 1e-12);
    CHECK(measure_stretch(surface, map).energy < 1 + std::pow(0.25, level)); // 0.82 of it
    CHECK(largest_distance(map.positions, expected) < 0.03 * std::pow(0.25, level));
  }
}

TEST_CASE("lambda makes the shear of a stretch map less extreme", "[stretch]") {
  const auto cow = test::benchmark_cow();
  if (!cow) return test::skip_without_cow();
  const ManifoldSurface surface = ManifoldSurface::from(*cow);
  const SphereMap plain = mapped(surface), damped = mapped(surface, {30, 0.1, false});
  check_bijective(surface, damped);
  const double back_plain = measure_stretch(surface, plain, 1).energy - measure_stretch(surface, plain).energy;
  const double back_damped = measure_stretch(surface, damped, 1).energy - measure_stretch(surface, damped).energy;
  CHECK(back_damped < back_plain);
}

TEST_CASE("bodies with few, flat, thin and coincident faces have stretch maps", "[stretch]") {
  std::mt19937 random(3);
  std::vector<RawMesh> meshes = {
      test::tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}),
      bipyramid(3),
      bipyramid(4), // an octahedron
      bipyramid(500),
      test::box({1, 1, 1}),
      test::box({1, 1e-3, 1e3}),
      split_midpoint(split_midpoint(test::box({1, 2, 3}))), // coplanar everywhere
      test::scaled(test::icosphere(3), {1, 1, 1000}),
      test::scaled(test::icosphere(3), {1, 1, 1e-4}),
      test::scaled(test::icosphere(2), Vec3::Constant(1e-40)),
      test::scaled(test::icosphere(2), Vec3::Constant(1e40)),
      test::translated(test::icosphere(2), Vec3::Constant(1e7)),
      test::convex_polyhedron(random, 200, 900),
  };
  RawMesh points = test::icosphere(3); // whole faces shrunk to a point, and needles beside them
  for (std::size_t f = 0; f < points.faces.size(); f += 37)
    for (const std::uint32_t v : points.faces[f]) points.vertices[v] = points.vertices[points.faces[f][0]];
  meshes.push_back(points);
  RawMesh line = test::icosphere(3); // a third of the body on a line
  for (Vec3& v : line.vertices)
    if (v[2] > 0.3) v[0] = v[1] = 0;
  meshes.push_back(line);
  RawMesh crumpled = test::icosphere(3);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  for (Vec3& v : crumpled.vertices) v += Vec3(uniform(random), uniform(random), uniform(random));
  meshes.push_back(crumpled);
  RawMesh unused = test::icosphere(1);
  unused.vertices.insert(unused.vertices.begin(), Vec3(5, 5, 5));
  for (Face& f : unused.faces)
    for (std::uint32_t& corner : f) ++corner;
  meshes.push_back(unused);

  for (std::size_t i = 0; i < meshes.size(); ++i)
    for (const bool converge : {false, true}) {
      INFO("mesh " << i << (converge ? ", converged" : ""));
      const ManifoldSurface surface = manifold(meshes[i]);
      const SphereMap map = mapped(surface, {30, 0, converge});
      check_bijective(surface, map);
    }
  CHECK(mapped(manifold(unused)).positions[0] == Vec3::Zero());
}

TEST_CASE("a tetrahedron's stretch map keeps its corners where they point", "[stretch]") {
  const double s = 1 / std::sqrt(3.0);
  const RawMesh mesh = test::tetrahedron({s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s});
  const SphereMap map = mapped(manifold(mesh), {30, 0, true});
  CHECK(largest_distance(map.positions, mesh.vertices) < 1e-7);
}

TEST_CASE("large and refined bodies have stretch maps without flips", "[stretch][long]") {
  const ManifoldSurface sphere = manifold(test::icosphere(6));
  check_bijective(sphere, mapped(sphere));
  const ManifoldSurface pyramid = manifold(bipyramid(5000));
  check_bijective(pyramid, mapped(pyramid));
  const auto cow = test::benchmark_cow();
  if (!cow) return test::skip_without_cow();
  const ManifoldSurface refined = manifold(split_midpoint(split_midpoint(cow->mesh())));
  check_bijective(refined, mapped(refined));
}

TEST_CASE("the energy of the benchmark's stretch map after many sweeps", "[stretch][long]") {
  const auto cow = test::benchmark_cow();
  if (!cow) return test::skip_without_cow();
  const ManifoldSurface surface = ManifoldSurface::from(*cow);
  CHECK(measure_stretch(surface, mapped(surface, {1000, 0, false})).energy < 2.16);
}

TEST_CASE("the stretch map refuses what is no sphere, and a lambda without sense", "[stretch]") {
  CHECK(fault_of(test::torus(9, 7)) == Fault::map_topology);
  CHECK(fault_of(test::two_shells()) == Fault::map_topology);
  CHECK(fault_of(test::shell_with_cavity()) == Fault::map_topology);
  for (const double lambda : {-1.0, std::nan(""), 1e300})
    CHECK(fault_of(test::icosphere(1), {30, lambda, false}) == Fault::bad_argument);
}

TEST_CASE("the stretch of a map with a flipped triangle is infinite", "[stretch]") {
  const RawMesh sphere = test::icosphere(1);
  std::vector<Vec3> positions = sphere.vertices;
  const ManifoldSurface surface = manifold(sphere);
  CHECK(std::isfinite(measure_stretch(surface, {MapMethod::file, positions, {}}).energy));
  positions[0] = -positions[0];
  const StretchMeasure measure = measure_stretch(surface, {MapMethod::file, positions, {}});
  CHECK(std::isinf(measure.energy));
  CHECK(std::isnan(measure.gradient));
}

TEST_CASE("the stretch map stops soon when asked to, and tells how far it is", "[stretch]") {
  struct Stopper : Monitor {
    int after = 0;
    double fraction = 0;
    mutable int asked = 0;
    void progress(const char*, double f) override {
      CHECK((f >= 0 && f <= 1));
      fraction = f;
    }
    bool stopped() const override { return ++asked > after; }
  };
  const ManifoldSurface surface = manifold(test::scaled(test::icosphere(3), {1, 1, 3}));
  Stopper never;
  never.after = 1 << 30;
  stretch_map(surface, {30, 0, true}, never);
  CHECK(never.asked > 60);
  for (int after = 0; after < never.asked; after += 29) {
    Stopper stopper;
    stopper.after = after;
    try {
      stretch_map(surface, {30, 0, true}, stopper);
      FAIL("it did not stop");
    } catch (const Error& error) {
      CHECK(error.fault() == Fault::interrupted);
      CHECK(stopper.asked == after + 1);
    }
  }
}
