#include "host/error.hpp"
#include "host/map/harmonic.hpp"
#include "host/map/moebius.hpp"
#include "host/map/quality.hpp"
#include "host/map/smooth.hpp"
#include "host/mesh/builtin.hpp"
#include "host/paper/recipe.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

ManifoldSurface manifold(RawMesh mesh) {
  return ManifoldSurface::from(ClosedSurface::from(std::move(mesh)));
}

HarmonicOptions at_vertex(std::uint32_t vertex, bool polish = false) {
  HarmonicOptions options;
  options.pole.rule = Pole::Rule::vertex;
  options.pole.vertex = vertex;
  options.centre = true;
  options.polish = polish;
  return options;
}

double furthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  REQUIRE(a.size() == b.size());
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

/// Root mean square distance, by the surface's area.
double apart(const ManifoldSurface& surface, const SphereMap& a, const SphereMap& b) {
  const auto areas = vertex_areas(surface);
  double sum = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) sum += areas[i] * (a.positions[i] - b.positions[i]).squaredNorm();
  return std::sqrt(sum);
}

Eigen::Matrix3d some_rotation() {
  return Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
}

Fault fault_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.fault();
  }
  FAIL("nothing was thrown");
  return Fault::check_failed;
}

} // namespace

TEST_CASE("the harmonic map of an icosphere tends to a Moebius map of itself", "[harmonic]") {
  // Centred and aligned, that is the identity.
  double before = 0;
  for (int level = 1; level <= 5; ++level) {
    const auto sphere = manifold(icosphere(level));
    const double off = furthest(harmonic_map(sphere, at_vertex(0)).positions, sphere.vertices());
    UNSCOPED_INFO("level " << level << " off by " << off);
    if (level > 3)
      CHECK(std::log2(before / off) == Approx(1).margin(0.2)); // of the first order: the pole's ring is round
    before = off;
  }
  CHECK(before < 0.01); // 0.0025
}

TEST_CASE("the polished and the smoothed map of an icosphere tend to itself", "[harmonic][smooth]") {
  double polished_before = 0, smooth_before = 0;
  for (int level = 1; level <= 4; ++level) {
    const auto sphere = manifold(icosphere(level));
    const double polished = furthest(harmonic_map(sphere, at_vertex(0, true)).positions, sphere.vertices());
    const double smooth = furthest(smooth_map(sphere).positions, sphere.vertices());
    UNSCOPED_INFO("level " << level << " polished " << polished << " smooth " << smooth);
    if (level > 2) {
      CHECK(polished < 0.4 * polished_before);
      CHECK(smooth < 0.5 * smooth_before);
    }
    polished_before = polished;
    smooth_before = smooth;
  }
  CHECK(polished_before < 2e-4);
  CHECK(smooth_before < 4e-5);
}

TEST_CASE("rotating the body rotates its map, and leaves it where it is without alignment", "[harmonic][smooth]") {
  std::mt19937 random(5);
  const RawMesh mesh = convex_polyhedron(random, 60, 100);
  const Eigen::Matrix3d rotation = some_rotation();
  const auto before = manifold(mesh), after = manifold(rotated(mesh, rotation));
  const auto turned = [&](std::vector<Vec3> positions) {
    for (Vec3& p : positions) p = rotation * p;
    return positions;
  };
  for (const EdgeWeights weights : {EdgeWeights::cotangent, EdgeWeights::mean_value, EdgeWeights::tutte}) {
    HarmonicOptions options = at_vertex(7);
    options.weights = weights;
    check_at_most(furthest(harmonic_map(after, options).positions, turned(harmonic_map(before, options).positions)),
                  4e-13, "aligned");
    options.align = options.centre = false;
    check_at_most(furthest(harmonic_map(after, options).positions, harmonic_map(before, options).positions), 4e-13,
                  "not aligned");
  }
  check_at_most(furthest(harmonic_map(after, at_vertex(7, true)).positions,
                         turned(harmonic_map(before, at_vertex(7, true)).positions)),
                1e-11, "polished");
  check_at_most(furthest(smooth_map(after).positions, turned(smooth_map(before).positions)), 1e-11, "smooth");
}

TEST_CASE("the map depends on neither the order of vertices nor the unit of length", "[harmonic]") {
  const RawMesh mesh = builtin_mesh("cow@1");
  HarmonicOptions options;
  options.centre = true;
  const auto plain = manifold(mesh), mixed = manifold(shuffled(mesh, 11));
  const SphereMap a = harmonic_map(plain, options), b = harmonic_map(mixed, options);
  double worst = 0;
  for (std::size_t i = 0; i < plain.vertices().size(); ++i)
    for (std::size_t j = 0; j < mixed.vertices().size(); ++j)
      if (plain.vertices()[i] == mixed.vertices()[j]) worst = std::max(worst, (a.positions[i] - b.positions[j]).norm());
  check_at_most(worst, 4e-12, "shuffled");
  for (const double factor : {1e-30, 1e30})
    check_at_most(
        furthest(harmonic_map(manifold(scaled(mesh, Vec3::Constant(factor))), options).positions, a.positions), 4e-12,
        "scaled");
}

TEST_CASE("positions are unit vectors, and zero for vertices of no face", "[harmonic][smooth]") {
  RawMesh mesh = icosphere(2);
  mesh.vertices.insert(mesh.vertices.begin(), Vec3(5, 5, 5)); // the vertex of no face comes first
  for (Face& f : mesh.faces)
    for (auto& v : f) ++v;
  const auto surface = manifold(std::move(mesh));
  for (const SphereMap& map : {harmonic_map(surface), harmonic_map(surface, at_vertex(3, true)), smooth_map(surface)}) {
    REQUIRE(map.positions.size() == surface.vertices().size());
    CHECK(map.positions[0] == Vec3(0, 0, 0));
    for (std::size_t i = 1; i < map.positions.size(); ++i) CHECK(std::abs(map.positions[i].norm() - 1) < 3e-16);
    CHECK(!map.notes.empty());
    CHECK(judge(surface, map, 8).flipped.empty());
  }
}

TEST_CASE("a tetrahedron has a harmonic map", "[harmonic]") {
  const auto surface = manifold(tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  for (const std::uint32_t pole : {0u, 1u, 2u, 3u}) {
    const MapQuality quality = judge(surface, harmonic_map(surface, at_vertex(pole)), 8);
    CHECK(quality.degree == Approx(1));
    CHECK(quality.flipped.empty());
  }
}

TEST_CASE("the harmonic map keeps angles by default, and does not without polish", "[harmonic]") {
  const auto body = manifold(builtin_mesh("ellipsoid:1,1,1.5@4"));
  const SphereMap map = harmonic_map(body);
  // In the triangles of a map that keeps angles there is shear of the first order in their size.
  const auto coarse = manifold(builtin_mesh("ellipsoid:1,1,1.5@3"));
  const double shear = judge(body, map, 8).shear[3], before = judge(coarse, harmonic_map(coarse), 8).shear[3];
  CHECK(shear < 1.03);
  CHECK(shear - 1 == Approx((before - 1) / 2).epsilon(0.1));
  HarmonicOptions options;
  options.pole = {Pole::Rule::vertex, 17, Vec3::Zero()};
  check_at_most(furthest(harmonic_map(body, options).positions, map.positions), 1e-9, "another pole");
  options.polish = false;
  CHECK(judge(body, harmonic_map(body, options), 8).shear[3] > 1.1);
  // What cannot be polished is not, unless it is asked for.
  options.polish.reset();
  options.weights = EdgeWeights::mean_value;
  const SphereMap uneven = harmonic_map(body, options);
  CHECK(std::any_of(uneven.notes.begin(), uneven.notes.end(),
                    [](const std::string& note) { return note.starts_with("not polished"); }));
  CHECK_FALSE(paper::harmonic_map().polish.value_or(true));
}

TEST_CASE("maps are refused for surfaces that are not one sphere", "[harmonic][smooth]") {
  CHECK(fault_of([] { harmonic_map(manifold(torus(12, 8))); }) == Fault::map_topology);
  CHECK(fault_of([] { smooth_map(manifold(torus(12, 8))); }) == Fault::map_topology);
  const RawMesh two = together(icosphere(1), translated(icosphere(1), {5, 0, 0}));
  CHECK(fault_of([&] { harmonic_map(manifold(two)); }) == Fault::map_topology);
  CHECK(fault_of([&] { smooth_map(manifold(two)); }) == Fault::map_topology);
  CHECK(fault_of([] {
          RawMesh open = icosphere(1);
          open.faces.pop_back();
          harmonic_map(manifold(std::move(open)));
        }) == Fault::mesh_open);
  CHECK(fault_of([] {
          RawMesh pinched = together(icosphere(0), translated(icosphere(0), {5, 0, 0}));
          for (Face& f : pinched.faces)
            for (auto& v : f)
              if (v == 12) v = 0;
          harmonic_map(manifold(std::move(pinched)));
        }) == Fault::mesh_vertex_manifold);
}

TEST_CASE("options that mean nothing are refused", "[harmonic][smooth]") {
  const auto surface = manifold(icosphere(1));
  for (const double scale : {-1.0, std::nan(""), HUGE_VAL}) {
    HarmonicOptions options;
    options.disk_scale = scale;
    CHECK(fault_of([&] { harmonic_map(surface, options); }) == Fault::bad_argument);
  }
  CHECK(fault_of([&] { harmonic_map(surface, at_vertex(42)); }) == Fault::bad_argument);
  HarmonicOptions nowhere;
  nowhere.pole = {Pole::Rule::point, 0, {0, std::nan(""), 0}};
  CHECK(fault_of([&] { harmonic_map(surface, nowhere); }) == Fault::bad_argument);
  HarmonicOptions uneven = at_vertex(0, true);
  uneven.weights = EdgeWeights::mean_value;
  CHECK(fault_of([&] { harmonic_map(surface, uneven); }) == Fault::bad_argument);
  SmoothOptions still;
  still.largest_step = 0;
  CHECK(fault_of([&] { smooth_map(surface, still); }) == Fault::bad_argument);
  SmoothOptions hasty;
  hasty.most_steps = 2;
  CHECK(fault_of([&] { smooth_map(manifold(box({1, 2, 3})), hasty); }) == Fault::map_failed);
}

TEST_CASE("poles are found by number, by nearness and on the back", "[harmonic]") {
  const auto sphere = manifold(icosphere(3));
  for (const std::uint32_t v : {0u, 17u, 641u})
    CHECK(pole_vertex(sphere, {Pole::Rule::point, 0, 1.5 * sphere.vertices()[v]}) == v);
  const Vec3 top = sphere.vertices()[pole_vertex(sphere, {})];
  for (const Vec3& v : sphere.vertices()) CHECK((v - Vec3(0, 1, 0)).norm() >= (top - Vec3(0, 1, 0)).norm());

  // A bent body that the ray misses: the nearest vertex to where it leaves the box.
  RawMesh banana = icosphere(3);
  for (Vec3& v : banana.vertices) v.z() = 0.2 * v.z() + 2 * v.x() * v.x();
  const auto bent = manifold(std::move(banana));
  const Vec3 found = bent.vertices()[pole_vertex(bent, {})], exit(0, 1, 0.9);
  CHECK(found.y() > 0);
  CHECK((found - exit).norm() < 1);
}

TEST_CASE("Moebius transformations are undone by their opposite and keep the sphere and its angles", "[moebius]") {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return SpherePoint(normal(random), normal(random), normal(random)); };
  for (int i = 0; i < 200; ++i) {
    const SpherePoint x = vector().normalized(), c = 0.9L * (i / 200.0L) * vector().normalized();
    const SpherePoint y = moebius(x, c);
    CHECK(double(std::abs(y.norm() - 1)) < 1e-18);
    CHECK(double((moebius(y, -c) - x).norm()) < 1e-16);
    // Small steps in two directions at right angles stay so, and of one length.
    const SpherePoint u = x.cross(vector()).normalized(), v = x.cross(u);
    const long double h = 1e-7L;
    const SpherePoint du = (moebius((x + h * u).normalized(), c) - moebius((x - h * u).normalized(), c)) / (2 * h);
    const SpherePoint dv = (moebius((x + h * v).normalized(), c) - moebius((x - h * v).normalized(), c)) / (2 * h);
    CHECK(double(std::abs(du.dot(dv)) / du.squaredNorm()) < 1e-8);
    CHECK(double(std::abs(du.norm() / dv.norm() - 1)) < 1e-8);
    CHECK(du.cross(dv).dot(y) * u.cross(v).dot(x) > 0);
  }
}

TEST_CASE("centring brings the mean to zero, and fails where half of the weight is at one point", "[moebius]") {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::vector<SpherePoint> x(100);
  const std::vector<double> weights(100, 0.01);
  for (SpherePoint& d : x) d = SpherePoint(normal(random), normal(random), 20 + normal(random)).normalized();
  x[5].setZero();
  CHECK(centre(x, weights) < 30);
  SpherePoint mean = SpherePoint::Zero();
  for (const SpherePoint& d : x) mean += 0.01L * d;
  CHECK(double(mean.norm()) < 1e-15);
  CHECK(x[5] == SpherePoint(0, 0, 0));
  for (std::size_t i = 0; i < 60; ++i) x[i] = SpherePoint(0, 0, 1);
  CHECK(fault_of([&] { centre(x, weights); }) == Fault::map_failed);
}

TEST_CASE("the plane is wrapped round the sphere without turning it over", "[moebius]") {
  CHECK(inverse_stereographic({0, 0}) == SpherePoint(0, 0, 1));
  CHECK(inverse_stereographic({1, 0}) == SpherePoint(1, 0, 0));
  CHECK(inverse_stereographic({0, 1}) == SpherePoint(0, 1, 0));
  CHECK(double(inverse_stereographic({1e9L, 0}).z()) == Approx(-1));
}

TEST_CASE("harmonic, polished and smoothed maps stop when asked to, and tell how far they are", "[harmonic][smooth]") {
  struct Stopper : Monitor {
    int after = 0, told = 0;
    mutable int asked = 0;
    void progress(const char*, double fraction) override {
      CHECK((fraction >= 0 && fraction <= 1));
      ++told;
    }
    bool stopped() const override { return ++asked > after; }
  };
  const auto body = manifold(scaled(icosphere(3), {1, 1, 3}));
  const std::vector<std::function<void(Monitor&)>> makers = {
      [&](Monitor& monitor) { (void)harmonic_map(body, {}, monitor); },
      [&](Monitor& monitor) { (void)harmonic_map(body, at_vertex(0, true), monitor); },
      [&](Monitor& monitor) { (void)smooth_map(body, {}, monitor); }};
  for (const auto& make : makers) {
    Stopper never;
    never.after = 1 << 30;
    make(never);
    CHECK(never.asked >= 4);
    CHECK(never.told >= 3);
    for (int after = 0; after < never.asked; ++after) {
      Stopper stopper;
      stopper.after = after;
      CHECK(fault_of([&] { make(stopper); }) == Fault::interrupted);
      CHECK(stopper.asked == after + 1);
    }
  }
}

TEST_CASE("mean-curvature flow and polish find the same map, the closer the finer the mesh", "[harmonic][smooth]") {
  double before = 0;
  for (int level = 1; level <= 3; ++level) {
    const auto cow = manifold(builtin_mesh(fmt::format("cow@{}", level)));
    HarmonicOptions options;
    options.polish = true;
    const double distance = apart(cow, harmonic_map(cow, options), smooth_map(cow));
    UNSCOPED_INFO("level " << level << ": " << distance);
    if (level > 1) CHECK(distance < 0.5 * before);
    before = distance;
  }
  CHECK(before < 2e-3);
}
