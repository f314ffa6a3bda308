#include "host/error.hpp"
#include "host/geometry/orientation.hpp"
#include "host/map/quality.hpp"
#include "tests/support/compare_moments.hpp"
#include "tests/support/meshes.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

ManifoldSurface manifold(RawMesh mesh) {
  return ManifoldSurface::from(ClosedSurface::from(std::move(mesh)));
}

/// Each vertex of a star-shaped surface to its direction.
SphereMap radial(const ManifoldSurface& surface) {
  SphereMap map{MapMethod::file, surface.vertices(), {}};
  for (Vec3& p : map.positions) p.normalize();
  return map;
}

bool says(const MapQuality& quality, const std::string& words) {
  for (const std::string& sentence : quality.sentences)
    if (sentence.find(words) != std::string::npos) return true;
  return false;
}

} // namespace

TEST_CASE("solid angles are those of known triangles, and tiny ones keep their digits", "[quality]") {
  const double pi = std::numbers::pi;
  CHECK(solid_angle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}) == Approx(pi / 2).epsilon(1e-15));
  CHECK(solid_angle({0, 1, 0}, {1, 0, 0}, {0, 0, 1}) == Approx(-pi / 2).epsilon(1e-15));
  // A lune's half: corners at a pole and on the equator, as large as the angle at the pole.
  for (const double angle : {1e-12, 1e-6, 0.1, 3.0})
    CHECK(solid_angle({0, 0, 1}, {1, 0, 0}, {std::cos(angle), std::sin(angle), 0}) == Approx(angle).epsilon(1e-14));
  const double side = 1e-9;
  CHECK(solid_angle({0, 0, 1}, {side, 0, 1}, {0, side, 1}) == Approx(side * side / 2).epsilon(1e-14));
}

TEST_CASE("an icosphere's map to itself is without fault", "[quality]") {
  const auto surface = manifold(scaled(icosphere(4), Vec3::Constant(3)));
  const MapQuality quality = judge(surface, radial(surface), 8);
  CHECK(quality.triangles == 5120);
  CHECK(std::abs(quality.degree - 1) < 1e-14);
  CHECK(!quality.inside_out);
  CHECK(quality.flipped.empty());
  CHECK(quality.flat.empty());
  // Chords are a little smaller than what they span, the large ones more so.
  for (const double ratio : quality.log_area_ratio) CHECK(std::abs(ratio) < 1e-3);
  for (const double shear : quality.shear) CHECK(std::abs(shear - 1) < 1e-14);
  CHECK(quality.smallest_area < 4 * std::numbers::pi / 5120);
  CHECK(quality.smallest_area > 0.5 * 4 * std::numbers::pi / 5120);
  CHECK(says(quality, "None of the 5120 triangles is flipped: the map is one-to-one"));
}

TEST_CASE("a mirrored map is inside-out, not flipped", "[quality]") {
  const auto surface = manifold(icosphere(2));
  SphereMap map = radial(surface);
  for (Vec3& p : map.positions) p.x() = -p.x();
  const MapQuality quality = judge(surface, map, 8);
  CHECK(quality.degree == Approx(-1));
  CHECK(quality.inside_out);
  CHECK(quality.flipped.empty());
  CHECK(says(quality, "inside-out"));
}

TEST_CASE("a folded map has flipped triangles although its signed areas add up to 4 pi", "[quality]") {
  const auto surface = manifold(icosphere(3));
  SphereMap map = radial(surface);
  // Vertex 0 goes past a neighbour.
  const Face& first = surface.faces().front();
  const Vec3 here = map.positions[first[0]], there = map.positions[first[1]];
  map.positions[first[0]] = (here + 1.5 * (there - here)).normalized();
  std::vector<std::uint32_t> expected;
  for (std::uint32_t f = 0; f < surface.faces().size(); ++f) {
    const Face& face = surface.faces()[f];
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = map.positions[face[std::size_t(k)]];
    if (corners.determinant() < 0) expected.push_back(f);
  }
  const MapQuality quality = judge(surface, map, 8);
  CHECK(expected.size() >= 2);
  CHECK(quality.flipped == expected);
  CHECK(quality.flipped_area > 0);
  CHECK(quality.flipped_area < 0.01);
  CHECK(std::abs(quality.degree - 1) < 1e-14);
  CHECK(says(quality, "not one-to-one"));
}

TEST_CASE("two neighbours at one place leave two triangles without area", "[quality]") {
  const auto surface = manifold(icosphere(3));
  SphereMap map = radial(surface);
  const Face& first = surface.faces().front();
  map.positions[first[0]] = map.positions[first[1]];
  const MapQuality quality = judge(surface, map, 8);
  CHECK(quality.flat.size() == 2);
  CHECK(quality.flat.front() == 0);
  CHECK(quality.smallest_area == 0);
  CHECK(quality.smallest_height == 0);
  CHECK(quality.log_area_ratio[0] == smallest_log_ratio);
  CHECK(std::isinf(quality.shear[3]));
}

TEST_CASE("the shear of a stretched sphere is the stretch", "[quality]") {
  // Stretched along z by 3, a sphere's triangles on the equator are sheared by 3, and none by more.
  const auto sphere = manifold(icosphere(5)), spheroid = manifold(scaled(icosphere(5), {1, 1, 3}));
  SphereMap map{MapMethod::file, sphere.vertices(), {}};
  const MapQuality quality = judge(spheroid, map, 8);
  CHECK(quality.shear[3] < 3 + 1e-12);
  CHECK(quality.shear[3] > 2.99);
  CHECK(quality.shear[0] > 2);
  // Areas: 1 at the poles, 3 at the equator, relative to the mean.
  CHECK(quality.log_area_ratio[5] - quality.log_area_ratio[0] == Approx(std::log10(3)).epsilon(0.01));
  CHECK(std::is_sorted(quality.log_area_ratio.begin(), quality.log_area_ratio.end()));
  CHECK(std::is_sorted(quality.shear.begin(), quality.shear.end()));
}

TEST_CASE("what a grid sees depends on its cells", "[quality]") {
  const auto surface = manifold(icosphere(3));
  const SphereMap map = radial(surface);
  const MapQuality fine = judge(surface, map, 512), coarse = judge(surface, map, 4);
  CHECK(fine.cell == Approx(std::numbers::pi / 1024));
  CHECK(fine.unseen == 0);
  CHECK(fine.parts.empty());
  CHECK(says(fine, "Every triangle is higher than a cell"));
  CHECK(coarse.unseen == 1280);
  CHECK(coarse.unseen_area == Approx(1));
  REQUIRE(coarse.parts.size() == 1);
  CHECK(coarse.parts[0].triangles == 1280);
  CHECK(coarse.parts[0].middle.norm() < 1e-14);
  CHECK(says(coarse, "cannot be seen at lmax 4"));
}

TEST_CASE("a map of another mesh is refused", "[quality]") {
  const auto surface = manifold(icosphere(1));
  const auto refused = [&](const SphereMap& map, int lmax) {
    try {
      judge(surface, map, lmax);
    } catch (const Error& error) {
      return error.fault() == Fault::bad_argument;
    }
    return false;
  };
  SphereMap map = radial(surface);
  CHECK(refused(map, 0));
  map.positions[3].x() = std::nan("");
  CHECK(refused(map, 8));
  map.positions.pop_back();
  CHECK(refused(map, 8));
}
