#include "host/mesh/closed_surface.hpp"

#include "host/error.hpp"
#include "host/mesh/audit.hpp"
#include "host/mesh/topology.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

using namespace cowgpu;

namespace {

RawMesh made(std::vector<Vec3> vertices, std::vector<Face> faces) {
  RawMesh mesh;
  mesh.name = "made";
  mesh.vertices = std::move(vertices);
  mesh.faces = std::move(faces);
  return mesh;
}

RawMesh tetrahedron() {
  return made({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
}

/// A grid of n x m quadrilaterals closed both ways; genus 1.
RawMesh torus(std::uint32_t n, std::uint32_t m, const std::function<Vec3(double, double)>& place) {
  RawMesh mesh = made({}, {});
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      mesh.vertices.push_back(place(2 * std::numbers::pi * i / n, 2 * std::numbers::pi * j / m));
      const std::uint32_t a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m,
                          d = i * m + (j + 1) % m;
      mesh.faces.push_back({a, b, c});
      mesh.faces.push_back({a, c, d});
    }
  return mesh;
}

Vec3 ring(double u, double v) {
  return {(3 + std::cos(v)) * std::cos(u), (3 + std::cos(v)) * std::sin(u), std::sin(v)};
}

/// Adds `more` as further shells.
RawMesh together(RawMesh mesh, const RawMesh& more) {
  const auto shift = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const Face& f : more.faces) mesh.faces.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
  return mesh;
}

RawMesh flipped(RawMesh mesh) {
  for (Face& f : mesh.faces) std::swap(f[1], f[2]);
  return mesh;
}

RawMesh moved(RawMesh mesh, double scale, const Vec3& shift) {
  for (Vec3& p : mesh.vertices) p = scale * p + shift;
  return mesh;
}

struct Failure {
  std::string fault = "none", message;
  bool says(const std::string& text) const { return message.find(text) != std::string::npos; }
};

Failure failure(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return {std::string(name(error.fault())), error.what()};
  }
  return {};
}

Failure closing(RawMesh mesh) {
  return failure([&] { ClosedSurface::from(std::move(mesh)); });
}

Failure mapping(RawMesh mesh) {
  return failure([&] { ManifoldSurface::from(ClosedSurface::from(std::move(mesh))); });
}

} // namespace

TEST_CASE("a closed mesh is taken over unchanged", "[closed]") {
  const RawMesh mesh = torus(7, 5, ring);
  const ClosedSurface surface = ClosedSurface::from(mesh);
  CHECK(surface.vertices() == mesh.vertices);
  CHECK(surface.faces() == mesh.faces);
  CHECK(surface.mesh().notes.empty());
  CHECK(mapping(mesh).fault == "none");
}

TEST_CASE("removing any face opens the surface", "[closed]") {
  const RawMesh whole = torus(7, 5, ring);
  for (std::size_t face = 0; face < whole.faces.size(); ++face) {
    RawMesh mesh = whole;
    mesh.faces.erase(mesh.faces.begin() + static_cast<std::ptrdiff_t>(face));
    const Failure f = closing(mesh);
    CHECK(f.fault == "mesh-open");
    CHECK(f.says("3 edges have"));
  }
}

TEST_CASE("flipping any face unbalances the surface", "[closed]") {
  const RawMesh whole = torus(7, 5, ring);
  for (std::size_t face = 0; face < whole.faces.size(); ++face) {
    RawMesh mesh = whole;
    std::swap(mesh.faces[face][0], mesh.faces[face][1]);
    const Failure f = closing(mesh);
    CHECK(f.fault == "mesh-unbalanced");
    CHECK(f.says("3 edges are run more often"));
  }
}

TEST_CASE("messages name the first offenders with face and line", "[closed]") {
  RawMesh mesh = tetrahedron();
  mesh.faces.pop_back();
  CHECK(closing(mesh).says("vertex 3 - vertex 0 (face 1)"));
  mesh.face_lines = {21, 22, 23};
  CHECK(closing(mesh).says("vertex 3 - vertex 0 (face 1, line 22)"));
  CHECK(closing(mesh).message.starts_with("made: "));

  mesh = torus(20, 20, ring);
  mesh.faces.resize(400);
  const std::string message = closing(mesh).message;
  CHECK(message.find("40 edges have") != std::string::npos);
  CHECK(message.find("the first are") != std::string::npos);
  CHECK(std::count(message.begin(), message.end(), ';') == 5); // four between five names, one in the advice
}

TEST_CASE("an open edge outweighs unbalanced ones, which are mentioned", "[closed]") {
  RawMesh mesh = torus(7, 5, ring);
  std::swap(mesh.faces[0][0], mesh.faces[0][1]);
  mesh.faces.erase(mesh.faces.begin() + 30);
  CHECK(closing(mesh).fault == "mesh-open");
  CHECK(closing(mesh).says("Besides, 3 edges are"));
}

TEST_CASE("orientation, emptiness and indices are checked", "[closed]") {
  CHECK(closing(flipped(tetrahedron())).fault == "mesh-inside-out");
  CHECK(closing(made({}, {})).fault == "mesh-empty");
  CHECK(closing(made({{0, 0, 0}}, {})).fault == "mesh-empty");
  CHECK(closing(made({}, {{0, 0, 0}})).fault == "mesh-empty");
  RawMesh mesh = tetrahedron();
  mesh.faces[2][1] = 4;
  CHECK(closing(mesh).fault == "mesh-index-range");
  CHECK(closing(mesh).says("face 2 names vertex 4"));
  CHECK(failure([&] { audit(mesh); }).fault == "mesh-index-range");
}

TEST_CASE("coordinates that are not finite are named, also of unused vertices", "[closed]") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  RawMesh mesh = tetrahedron();
  mesh.vertices[2].y() = nan;
  CHECK(closing(mesh).fault == "mesh-not-finite");
  CHECK(closing(mesh).says("vertex 2 (0, nan, 0)"));
  mesh = tetrahedron();
  mesh.vertices.push_back({0, -inf, 0});
  CHECK(closing(mesh).fault == "mesh-not-finite");
  CHECK(audit(mesh).not_finite_vertices == 1);
  CHECK_FALSE(audit(mesh).finite);
}

TEST_CASE("sizes from 1e-50 to 1e50 are accepted and cubes stay exact", "[closed]") {
  for (const double scale : {1e-50, 1e-30, 1e-10, 1e10, 1e30, 1e50}) {
    INFO(scale);
    const ClosedSurface surface = ClosedSurface::from(moved(tetrahedron(), scale, Vec3::Zero()));
    CHECK(volume(surface) == Approx(scale * scale * scale / 6).epsilon(1e-15).scale(0));
    CHECK(centre_of_mass(surface).isApprox(Vec3::Constant(scale / 4), 1e-15));
  }
  CHECK(closing(moved(tetrahedron(), 1e51, Vec3::Zero())).fault == "mesh-range");
  CHECK(closing(moved(tetrahedron(), 1e-51, Vec3::Zero())).fault == "mesh-range");
  CHECK(closing(moved(tetrahedron(), 1e307, Vec3::Zero())).fault == "mesh-range");
  CHECK(closing(moved(tetrahedron(), 1e-310, Vec3::Zero())).fault == "mesh-range");
  CHECK(closing(moved(tetrahedron(), 0, Vec3::Ones())).fault == "mesh-no-volume");
}

TEST_CASE("thin bodies are told from flat ones by the rounding of their coordinates", "[closed]") {
  const auto thick = [](double thickness) {
    RawMesh mesh = tetrahedron();
    mesh.vertices[3].z() = thickness;
    return mesh;
  };
  CHECK(closing(thick(1e-14)).fault == "none");
  CHECK(closing(thick(1e-17)).fault == "mesh-no-volume");
  // The same body, far enough away to be flat.
  CHECK(closing(moved(thick(1e-3), 1, Vec3::Constant(1e10))).fault == "none");
  CHECK(closing(moved(thick(1e-3), 1, Vec3::Constant(1e14))).fault == "mesh-no-volume");
}

TEST_CASE("unused vertices are noted", "[closed]") {
  RawMesh mesh = tetrahedron();
  mesh.vertices.push_back({5, 5, 5});
  const ClosedSurface surface = ClosedSurface::from(mesh);
  REQUIRE(surface.mesh().notes.size() == 1);
  CHECK(surface.mesh().notes[0].starts_with("1 vertex belongs"));
  CHECK(mapping(mesh).fault == "none");
  CHECK(bounding_box(surface).max == Vec3::Ones());
  CHECK(brillouin_radius(surface, Vec3::Zero()) == 1);
}

TEST_CASE("faces that repeat a vertex are enough for volumes but not for maps", "[closed]") {
  RawMesh mesh = tetrahedron();
  mesh.faces.push_back({0, 0, 1});
  mesh.faces.push_back({2, 2, 2});
  CHECK(closing(mesh).fault == "none");
  CHECK(mapping(mesh).fault == "mesh-edge-manifold");
  CHECK(mapping(mesh).says("2 faces name a vertex twice (degenerate): face 4; face 5"));
}

TEST_CASE("vertices where two sheets touch are named", "[closed]") {
  // Vertex 0 of a torus is glued to vertex 0 of a far tetrahedron, whose own vertex 0 then is unused.
  RawMesh mesh = together(torus(7, 5, ring), moved(tetrahedron(), 1, {9, 9, 9}));
  for (Face& f : mesh.faces) std::replace(f.begin(), f.end(), 35U, 0U);
  CHECK(closing(mesh).fault == "none");
  const Failure f = mapping(mesh);
  CHECK(f.fault == "mesh-vertex-manifold");
  CHECK(f.says(": vertex 0."));
  CHECK(audit(mesh).pinched_vertices == 1);
  CHECK(audit(mesh).components == 2);
}

TEST_CASE("volume and centre of mass are exact to the last bit on integer polyhedra", "[geometry]") {
  // Any function on the torus's grid gives a closed surface; sums over integer coordinates are exact in 128 bits.
  __extension__ using Int = __int128;
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round) {
    const std::int64_t shift = round % 2 == 0 ? 0 : std::int64_t{1} << 30;
    RawMesh mesh = torus(9, 8, [&](double, double) {
      return Vec3(static_cast<double>(random() % 2000 + shift), static_cast<double>(random() % 2000 + shift),
                  static_cast<double>(random() % 2000));
    });
    Int six = 0, moment[3] = {0, 0, 0};
    for (const Face& f : mesh.faces) {
      Int p[3][3];
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) p[i][k] = static_cast<std::int64_t>(mesh.vertices[f[i]][k]);
      const Int det = p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
                      p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
                      p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
      six += det;
      for (int k = 0; k < 3; ++k) moment[k] += det * (p[0][k] + p[1][k] + p[2][k]);
    }
    if (six < 0) {
      mesh = flipped(mesh);
      six = -six;
      for (Int& m : moment) m = -m;
    }
    const ClosedSurface surface = ClosedSurface::from(mesh);
    const auto size = static_cast<long double>(six);
    CHECK(std::fabs(volume(surface) / static_cast<double>(size / 6) - 1) <= 0x1p-52);
    const Vec3 centre = centre_of_mass(surface);
    for (int k = 0; k < 3; ++k) {
      // Whole and remainder apart: the moment may have more digits than a long double.
      const Int whole = moment[k] / (4 * six);
      const auto expected = static_cast<double>(static_cast<long double>(whole) +
                                                static_cast<long double>(moment[k] % (4 * six)) / (4 * size));
      CHECK(std::fabs(centre[k] / expected - 1) <= 0x1p-51);
    }
  }
}

TEST_CASE("area, box and radius of a box are exact", "[geometry]") {
  const RawMesh mesh =
      made({{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}, {0, 0, 6}, {2, 0, 6}, {2, 3, 6}, {0, 3, 6}}, {{0, 3, 2},
                                                                                                      {0, 2, 1},
                                                                                                      {4, 5, 6},
                                                                                                      {4, 6, 7},
                                                                                                      {0, 1, 5},
                                                                                                      {0, 5, 4},
                                                                                                      {1, 2, 6},
                                                                                                      {1, 6, 5},
                                                                                                      {2, 3, 7},
                                                                                                      {2, 7, 6},
                                                                                                      {3, 0, 4},
                                                                                                      {3, 4, 7}});
  const ClosedSurface surface = ClosedSurface::from(mesh);
  CHECK(volume(surface) == 36);
  CHECK(area(surface) == 72);
  CHECK(centre_of_mass(surface) == Vec3(1, 1.5, 3));
  CHECK(bounding_box(surface).min == Vec3::Zero());
  CHECK(bounding_box(surface).max == Vec3(2, 3, 6));
  CHECK(brillouin_radius(surface, Vec3::Zero()) == 7);
  CHECK(brillouin_radius(surface, Vec3(1, 1.5, 3)) == 3.5);
  CHECK(volume(ClosedSurface::from(moved(mesh, 1, Vec3::Constant(1e9)))) == 36);
}

TEST_CASE("a tessellated torus converges to its closed forms", "[geometry]") {
  const double pi = std::numbers::pi, exact_volume = 6 * pi * pi, exact_area = 12 * pi * pi;
  const ClosedSurface coarse = ClosedSurface::from(torus(100, 80, ring)),
                      fine = ClosedSurface::from(torus(200, 160, ring));
  CHECK((volume(fine) * 4 - volume(coarse)) / 3 == Approx(exact_volume).epsilon(1e-6));
  CHECK((area(fine) * 4 - area(coarse)) / 3 == Approx(exact_area).epsilon(1e-5));
  CHECK((exact_volume - volume(coarse)) / (exact_volume - volume(fine)) == Approx(4).epsilon(0.01));
  CHECK(centre_of_mass(fine).norm() < 1e-15);
}

TEST_CASE("an audit tells the facts of a good mesh", "[audit]") {
  const Audit a = audit(torus(7, 5, ring));
  CHECK((a.vertices == 35 && a.faces == 70 && a.edges == 105));
  CHECK((a.finite && a.closed && a.consistently_oriented && a.edge_manifold && a.vertex_manifold && a.outward));
  CHECK((a.open_edges == 0 && a.unbalanced_edges == 0 && a.crowded_edges == 0 && a.pinched_vertices == 0));
  CHECK((a.unused_vertices == 0 && a.repeating_faces == 0 && a.duplicate_faces == 0 && a.degenerate_faces == 0));
  CHECK((a.components == 1 && a.cavities == 0 && a.euler_characteristic == 0 && a.genus == 1));
  CHECK(a.coincident_groups == 0);
  CHECK((a.volume.has_value() && a.centre_of_mass.has_value() && a.area > 0));
  CHECK((a.shortest_edge > 0 && a.shortest_edge < a.longest_edge));
}

TEST_CASE("an audit counts shells, cavities and genus", "[audit]") {
  const RawMesh outer = moved(torus(7, 5, ring), 2, Vec3::Zero());
  const RawMesh inner = moved(flipped(tetrahedron()), 0.1, {5.8, 0, 0});
  const Audit a = audit(together(together(outer, inner), moved(torus(5, 5, ring), 1, {30, 0, 0})));
  CHECK((a.components == 3 && a.cavities == 1 && a.genus == 2 && a.outward));
  const Audit b = audit(flipped(tetrahedron()));
  CHECK((!b.outward && b.cavities == 1 && b.genus == 0));
  CHECK(b.volume == Approx(-1.0 / 6));
}

TEST_CASE("an audit counts what is wrong and throws nothing", "[audit]") {
  RawMesh mesh = torus(7, 5, ring);
  mesh.faces.erase(mesh.faces.begin() + 40);
  std::swap(mesh.faces[0][0], mesh.faces[0][1]);
  mesh.vertices.push_back(mesh.vertices[3]);
  mesh.vertices.push_back(mesh.vertices[3]);
  mesh.vertices.push_back({1, 2, 3});
  const Audit a = audit(mesh);
  CHECK((!a.closed && !a.consistently_oriented && a.edge_manifold && a.vertex_manifold));
  CHECK((a.open_edges == 3 && a.unbalanced_edges == 3 && a.unused_vertices == 3 && a.coincident_groups == 1));
  CHECK((!a.volume && !a.centre_of_mass && !a.genus && a.area > 0));

  mesh = tetrahedron();
  mesh.vertices.push_back({0.5, 0, 0});
  mesh.faces.insert(mesh.faces.end(), {{0, 1, 4}, {0, 4, 1}, {1, 1, 2}, {0, 1, 2}, {1, 2, 0}});
  const Audit b = audit(mesh);
  CHECK((b.degenerate_faces == 3 && b.repeating_faces == 1 && b.duplicate_faces == 3));
  CHECK((b.crowded_edges > 0 && !b.edge_manifold && !b.genus));

  const Audit nothing = audit(RawMesh{});
  CHECK((!nothing.closed && nothing.faces == 0 && nothing.components == 0 && nothing.longest_edge == 0));
}

TEST_CASE("edge uses lie together and run both ways", "[topology]") {
  const RawMesh mesh = torus(7, 5, ring);
  const std::vector<EdgeUse> uses = edge_uses(mesh.faces, mesh.vertices.size());
  CHECK(uses.size() == 3 * mesh.faces.size());
  std::size_t edges = 0;
  for_each_edge(uses, [&](std::span<const EdgeUse> edge) {
    ++edges;
    CHECK((edge.size() == 2 && balance(edge).balanced() && edge[0].low < edge[0].high));
  });
  CHECK(edges == 105);
}
