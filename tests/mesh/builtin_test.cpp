#include "host/error.hpp"
#include "host/io/sha256.hpp"
#include "host/mesh/builtin.hpp"
#include "host/mesh/builtin_cow.hpp"
#include "host/mesh/self_intersections.hpp"
#include "host/mesh/subdivide.hpp"

#include <catch2/catch.hpp>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

using namespace cowgpu;

namespace {

const double pi = std::acos(-1.0);

struct Integrals {
  double volume = 0;
  Vec3 centroid = Vec3::Zero();
};

/// In extended precision, so that figures are about the mesh and not about the sum.
Integrals integrate(const RawMesh& mesh) {
  using Wide = Eigen::Matrix<long double, 3, 1>;
  long double sum = 0;
  Wide moment = Wide::Zero();
  for (const auto& [a, b, c] : mesh.faces) {
    const Wide p = mesh.vertices[a].cast<long double>(), q = mesh.vertices[b].cast<long double>(),
               r = mesh.vertices[c].cast<long double>();
    const long double v = p.dot(q.cross(r)) / 6;
    sum += v;
    moment += v * (p + q + r) / 4;
  }
  return {static_cast<double>(sum), Vec3((moment / sum).cast<double>())};
}

double volume(const RawMesh& mesh) {
  return integrate(mesh).volume;
}

/// The directed edges, sorted.
std::vector<std::pair<std::uint32_t, std::uint32_t>> directed_edges(const RawMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Face& f : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(f[k], f[(k + 1) % 3]);
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// With every directed edge once and its reverse there, each vertex has one fan if the fan found by walking from one
/// face round it is as large as its number of faces.
bool one_fan_each(const RawMesh& mesh) {
  std::vector<std::size_t> valence(mesh.vertices.size(), 0);
  std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>> opposite;
  std::vector<std::uint32_t> start(mesh.vertices.size(), std::numeric_limits<std::uint32_t>::max());
  for (const Face& f : mesh.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      ++valence[f[k]];
      start[f[k]] = f[(k + 1) % 3];
      opposite.push_back({{f[k], f[(k + 1) % 3]}, f[(k + 2) % 3]});
    }
  std::sort(opposite.begin(), opposite.end());
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    std::size_t steps = 0;
    std::uint32_t w = start[v];
    if (valence[v] == 0) return false;
    do {
      const auto key = std::pair(std::pair(v, w), std::uint32_t{0});
      w = std::lower_bound(opposite.begin(), opposite.end(), key)->second;
      ++steps;
    } while (w != start[v] && steps <= valence[v]);
    if (steps != valence[v]) return false;
  }
  return true;
}

void require_sphere_like(const RawMesh& mesh) {
  const auto edges = directed_edges(mesh);
  REQUIRE(std::adjacent_find(edges.begin(), edges.end()) == edges.end());
  REQUIRE(std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
    return std::binary_search(edges.begin(), edges.end(), std::pair(e.second, e.first));
  }));
  REQUIRE(one_fan_each(mesh));
  REQUIRE(mesh.vertices.size() + mesh.faces.size() == edges.size() / 2 + 2);
  REQUIRE(volume(mesh) > 0);
  double least_height = std::numeric_limits<double>::infinity(); // against the longest side
  for (const auto& [a, b, c] : mesh.faces) {
    const Vec3 p = mesh.vertices[b] - mesh.vertices[a], q = mesh.vertices[c] - mesh.vertices[a];
    const double longest = std::max({p.squaredNorm(), q.squaredNorm(), (p - q).squaredNorm()});
    least_height = std::min(least_height, p.cross(q).norm() / longest);
  }
  REQUIRE(least_height > 1e-3);
}

/// How far the mirrored vertex set is from the vertex set, or infinity if a vertex has no image within `reach`.
double asymmetry(const RawMesh& mesh, double reach) {
  std::vector<Vec3> sorted = mesh.vertices;
  std::sort(sorted.begin(), sorted.end(), [](const Vec3& a, const Vec3& b) { return a.x() < b.x(); });
  double worst = 0;
  for (const Vec3& v : mesh.vertices) {
    const Vec3 image(v.x(), v.y(), -v.z());
    double nearest = std::numeric_limits<double>::infinity();
    auto near = std::lower_bound(sorted.begin(), sorted.end(), image.x() - reach,
                                 [](const Vec3& a, double x) { return a.x() < x; });
    for (; near != sorted.end() && near->x() <= image.x() + reach; ++near)
      nearest = std::min(nearest, (*near - image).norm());
    worst = std::max(worst, nearest);
  }
  return worst;
}

Fault fault_of(const std::string& spec) {
  try {
    builtin_mesh(spec);
  } catch (const Error& error) {
    INFO(error.what());
    CHECK(std::string(error.what()).find("builtin:" + spec) != std::string::npos);
    return error.fault();
  }
  FAIL("accepted: " << spec);
  return Fault::check_failed;
}

RawMesh single_triangle() {
  RawMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}};
  return mesh;
}

} // namespace

TEST_CASE("every built-in body is closed, 2-manifold, of genus 0, and looks outward", "[builtin]") {
  const std::string spec = GENERATE("cow@0", "cow@1", "cow@2", "cow@3", "sphere@0", "sphere@1", "sphere@5",
                                    "sphere:1e-9@3", "box", "box@3", "box:3,2,1e-2@1", "ellipsoid:3,2,1@0",
                                    "ellipsoid:1,2,30@4", "tetrahedron", "tetrahedron:7@4", "asteroid@0", "asteroid@5",
                                    "asteroid:0@4", "asteroid:4294967295@4", "binary@0", "binary@5", "binary:17@4");
  INFO(spec);
  require_sphere_like(builtin_mesh(spec));
}

TEST_CASE("asteroids and contact binaries of many seeds do not intersect themselves", "[builtin][asteroid]") {
  for (const char* name : {"asteroid", "binary"})
    for (int seed = 0; seed < 12; ++seed) {
      const RawMesh mesh = builtin_mesh(fmt::format("{}:{}@{}", name, seed, seed == 0 ? 5 : 4));
      INFO(mesh.name);
      const SelfIntersections found =
          self_intersections(mesh.vertices, mesh.faces, Bvh(mesh.vertices, mesh.faces), silent_monitor());
      CHECK(found.pairs.empty());
      CHECK(volume(mesh) > 1);
      double near = HUGE_VAL, far = 0;
      for (const Vec3& v : mesh.vertices) near = std::min(near, v.norm()), far = std::max(far, v.norm());
      // The origin is well inside; the neck of a binary is its nearest part.
      CHECK((near > 0.2 && far < 2.5));
    }
}

TEST_CASE("a finer asteroid only adds vertices, and another seed is another body", "[builtin][asteroid]") {
  for (const char* name : {"asteroid", "binary"}) {
    const auto body = [&](const std::string& more) { return builtin_mesh(name + more); };
    const RawMesh coarse = body(":5@3"), fine = body(":5@4"), other = body(":6@3");
    double moved = 0, differs = 0;
    for (std::size_t v = 0; v < coarse.vertices.size(); ++v) {
      moved = std::max(moved, (coarse.vertices[v] - fine.vertices[v]).norm());
      differs = std::max(differs, (coarse.vertices[v] - other.vertices[v]).norm());
    }
    CHECK(moved < 1e-14); // a sphere's vertices are brought to it at every level
    CHECK(differs > 0.02);
  }
}

TEST_CASE("asteroids have the same bits everywhere", "[builtin][asteroid]") {
  const auto hash = [](const std::string& spec) {
    const RawMesh mesh = builtin_mesh(spec);
    std::string bytes;
    for (const Vec3& v : mesh.vertices) bytes.append(reinterpret_cast<const char*>(v.data()), 3 * sizeof(double));
    return sha256_hex(bytes);
  };
  CHECK(hash("asteroid:7@3") == "f289e7909aaa2df4f2f019f5c56a76eb13e434b9f497e11821697ce91b69db7d");
  CHECK(hash("binary:7@3") == "c09201c142d6aa89cda66eb16481b06e4058d5b117dd12c953dce7cc38283007");
}

TEST_CASE("the cow is the mirror image of herself", "[builtin]") {
  CHECK(asymmetry(cow_cage(), 1e-12) == 0);
  for (int level : {0, 1, 2, 3}) {
    INFO("level " << level);
    const RawMesh cow = builtin_mesh("cow@" + std::to_string(level));
    CHECK(asymmetry(cow, 1e-12) < 1e-15);
    CHECK(std::abs(integrate(cow).centroid.z()) < 1e-12);
  }
}

TEST_CASE("the cow is about one unit long, stands on the ground and looks forward", "[builtin]") {
  const RawMesh cow = builtin_mesh("cow");
  Vec3 low = cow.vertices[0], high = low;
  for (const Vec3& v : cow.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
  CHECK(high.x() - low.x() == Approx(1.0).margin(0.15));
  CHECK(std::abs(low.y()) < 0.01);
  CHECK(high.x() > -low.x()); // head and neck reach further than the tail
  CHECK(high.y() - low.y() > high.z() - low.z());
}

TEST_CASE("other lengths give another cow, of the same topology", "[builtin]") {
  CowLengths lengths;
  lengths.leg_length *= 1.2;
  lengths.horn_length *= 0.8;
  const RawMesh cow = cow_cage(lengths);
  CHECK(cow.faces.size() == cow_cage().faces.size());
  require_sphere_like(cow);
  for (double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    lengths.tail_length = bad;
    CHECK_THROWS_AS(cow_cage(lengths), Error);
  }
}

TEST_CASE("the icosphere's volume converges to the ball's with order 2", "[builtin]") {
  std::vector<double> errors;
  for (int level = 2; level <= 7; ++level) {
    errors.push_back(4 * pi / 3 - volume(builtin_mesh("sphere@" + std::to_string(level))));
    CHECK(errors.back() > 0);
  }
  for (std::size_t i = 1; i < errors.size(); ++i)
    CHECK(std::log2(errors[i - 1] / errors[i]) == Approx(2).margin(0.1 * std::pow(0.25, i - 1)));
}

TEST_CASE("the vertices of a sphere lie on it", "[builtin]") {
  double worst = 0;
  for (const Vec3& v : builtin_mesh("sphere:2.5@5").vertices) worst = std::max(worst, std::abs(v.norm() / 2.5 - 1));
  CHECK(worst < 1e-15);
}

TEST_CASE("an ellipsoid is a scaled sphere", "[builtin]") {
  CHECK(volume(builtin_mesh("ellipsoid:3,2,0.5@4")) == Approx(3 * volume(builtin_mesh("sphere@4"))).epsilon(1e-14));
  CHECK(builtin_mesh("ellipsoid:2,2,2@3").vertices == builtin_mesh("sphere:2@3").vertices);
}

TEST_CASE("boxes and tetrahedra have their closed-form volume and are centred, at every level", "[builtin]") {
  for (const char* level : {"", "@0", "@1", "@4"}) {
    INFO(level);
    const Integrals unit = integrate(builtin_mesh("box" + std::string(level)));
    const Integrals box = integrate(builtin_mesh("box:3,0.5,7" + std::string(level)));
    const Integrals tetrahedron = integrate(builtin_mesh("tetrahedron:2" + std::string(level)));
    CHECK(unit.volume == Approx(1).epsilon(1e-15));
    CHECK(box.volume == Approx(10.5).epsilon(1e-14));
    CHECK(tetrahedron.volume == Approx(8 / (6 * std::sqrt(2.0))).epsilon(1e-14));
    CHECK(box.centroid.norm() < 1e-14);
    CHECK(tetrahedron.centroid.norm() < 1e-14);
  }
}

TEST_CASE("a tetrahedron's edges have the length asked for", "[builtin]") {
  const RawMesh mesh = builtin_mesh("tetrahedron:3");
  for (const auto& [a, b] : directed_edges(mesh))
    CHECK((mesh.vertices[a] - mesh.vertices[b]).norm() == Approx(3).epsilon(1e-15));
}

TEST_CASE("the name is canonical: it shows the sizes and the level used", "[builtin]") {
  using Pair = std::pair<std::string, std::string>;
  const auto [spec, name] =
      GENERATE(Pair{"cow", "cow@3"}, Pair{"cow@1", "cow@1"}, Pair{"cow@01", "cow@1"}, Pair{"cow@+1", "cow@1"},
               Pair{"sphere", "sphere:1@4"}, Pair{"sphere@0", "sphere:1@0"}, Pair{"sphere:+1@0", "sphere:1@0"},
               Pair{"sphere:0.50@2", "sphere:0.5@2"}, Pair{"sphere:1e3@0", "sphere:1000@0"}, Pair{"box", "box:1,1,1@0"},
               Pair{"box:1,2.0,3", "box:1,2,3@0"}, Pair{"ellipsoid:3,2,1", "ellipsoid:3,2,1@4"},
               Pair{"tetrahedron", "tetrahedron:1@0"}, Pair{"asteroid@2", "asteroid:1@2"},
               Pair{"asteroid:007@0", "asteroid:7@0"}, Pair{"binary:4294967295@1", "binary:4294967295@1"},
               Pair{"tetrahedron:0.1@2", "tetrahedron:0.1@2"});
  const RawMesh mesh = builtin_mesh(spec);
  CHECK(mesh.name == "builtin:" + name);
  CHECK(mesh.sha256.empty());
  CHECK(mesh.face_lines.empty());
  const RawMesh again = builtin_mesh(mesh.name.substr(8));
  CHECK(again.vertices == mesh.vertices);
  CHECK(again.faces == mesh.faces);
}

TEST_CASE("a bad name, level or size is refused, with the reason", "[builtin]") {
  const std::string spec = GENERATE(
      "", "@", ":", "bull", "Cow", "cow ", " cow", "cow@", "cow@9", "cow@-1", "cow@3x", "cow@3.0", "cow@ 3", "cow@3@3",
      "cow@4294967296", "cow@99999999999999999999", "cow:1", "cow:", "sphere@10", "sphere:", "sphere:0", "sphere:-1",
      "sphere:nan", "sphere:inf", "sphere:1e31", "sphere:1e-31", "sphere:1e999", "sphere:1,2", "sphere:1x", "sphere: 1",
      "sphere:1 @4", "sphere:1@4junk", "sphere@4:1", "box:1", "box:1,2", "box:1,2,3,4", "box:1,,2", "box:1,2,",
      "box:,1,2", "box:1,2,0", "box:1,2,nan", "box:1,1,1e7", "box@12", "ellipsoid", "ellipsoid@4", "ellipsoid:1,1",
      "ellipsoid:1,1,1@10", "tetrahedron:1,2", "tetrahedron@13", "sphere:0x1", "asteroid:", "asteroid:-1",
      "asteroid:1.5", "asteroid:4294967296", "asteroid:1,2", "asteroid@10", "binary:moon", "binary@10");
  INFO(spec);
  CHECK(fault_of(spec) == Fault::bad_argument);
}

TEST_CASE("help knows every body, and no allowed level exceeds the face limit", "[builtin]") {
  REQUIRE(builtin_bodies().size() == 7);
  for (const BuiltinBody& body : builtin_bodies()) {
    INFO(body.name);
    CHECK(body.usage.rfind(body.name, 0) == 0);
    CHECK_FALSE(body.description.empty());
  }
  const std::uint64_t cow = cow_cage().faces.size();
  CHECK(cow == 820);
  CHECK(cow << 16 <= builtin_face_limit);
}

TEST_CASE("a midpoint split quadruples the faces and leaves the volume", "[subdivide]") {
  const std::string spec = GENERATE("cow@0", "cow@2", "sphere@2", "box:1,2,3", "tetrahedron");
  const RawMesh mesh = builtin_mesh(spec), split = split_midpoint(mesh);
  CHECK(split.faces.size() == 4 * mesh.faces.size());
  CHECK(split.vertices.size() == mesh.vertices.size() + 3 * mesh.faces.size() / 2);
  CHECK(volume(split) == Approx(volume(mesh)).epsilon(1e-14));
  CHECK(std::equal(mesh.vertices.begin(), mesh.vertices.end(), split.vertices.begin()));
  require_sphere_like(split);
}

TEST_CASE("a midpoint split takes open meshes, shares midpoints and keeps the lines", "[subdivide]") {
  RawMesh mesh = single_triangle();
  mesh.vertices.push_back({1, 1, 0});
  mesh.faces.push_back({1, 3, 2});
  mesh.face_lines = {10, 20};
  const RawMesh split = split_midpoint(mesh);
  CHECK(split.vertices.size() == 4 + 5);
  CHECK(split.faces.size() == 8);
  CHECK(split.face_lines == std::vector<std::uint32_t>{10, 10, 10, 10, 20, 20, 20, 20});
  CHECK(split_midpoint(RawMesh{}).faces.empty());
}

TEST_CASE("Loop's rule has its known weights", "[subdivide]") {
  const RawMesh before = builtin_mesh("tetrahedron"), after = loop_subdivide(before);
  REQUIRE(after.faces.size() == 16);
  // At valence 3 the vertex weight is 1 - 9/16, and the other three corners sum to minus this one.
  for (std::size_t v = 0; v < 4; ++v) CHECK((after.vertices[v] - 0.25 * before.vertices[v]).norm() < 1e-15);
  // Each edge point is 3/8 of its ends plus 1/8 of the other two, which again sum to minus the ends: a quarter.
  for (std::size_t e = 4; e < 10; ++e) CHECK(after.vertices[e].norm() == Approx(0.25 * std::sqrt(0.5)).epsilon(1e-14));
}

TEST_CASE("Loop subdivision keeps a body closed and manifold, and shrinks a convex one", "[subdivide]") {
  const std::string spec = GENERATE("tetrahedron", "box", "sphere@1", "sphere@3", "ellipsoid:3,2,1@2");
  const RawMesh mesh = builtin_mesh(spec), smooth = loop_subdivide(loop_subdivide(mesh));
  CHECK(smooth.faces.size() == 16 * mesh.faces.size());
  require_sphere_like(smooth);
  CHECK(volume(smooth) < volume(mesh));
}

TEST_CASE("Loop subdivision commutes with a shift", "[subdivide]") {
  RawMesh mesh = builtin_mesh("cow@0");
  const RawMesh smooth = loop_subdivide(mesh);
  const Vec3 shift(3, -2, 5);
  for (Vec3& v : mesh.vertices) v += shift;
  const RawMesh shifted = loop_subdivide(mesh);
  double worst = 0;
  for (std::size_t v = 0; v < smooth.vertices.size(); ++v)
    worst = std::max(worst, (shifted.vertices[v] - shift - smooth.vertices[v]).norm());
  CHECK(worst < 1e-14);
}

TEST_CASE("Loop subdivision refuses what is no closed manifold, by name", "[subdivide]") {
  auto fault = [](const RawMesh& mesh) {
    try {
      loop_subdivide(mesh);
    } catch (const Error& error) {
      return error.fault();
    }
    return Fault::check_failed;
  };
  RawMesh mesh = single_triangle();
  CHECK(fault(mesh) == Fault::mesh_open);
  mesh.faces.push_back({0, 1, 2});
  CHECK(fault(mesh) == Fault::mesh_unbalanced);
  mesh.faces.push_back({2, 1, 0});
  CHECK(fault(mesh) == Fault::mesh_edge_manifold);
  mesh.faces = {{0, 1, 3}};
  CHECK(fault(mesh) == Fault::mesh_index_range);
  CHECK_THROWS_AS(split_midpoint(mesh), Error);
}
