#include "tests/support/meshes.hpp"

#include "host/io/file.hpp"
#include "host/io/off.hpp"
#include "host/io/sha256.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/subdivide.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <numbers>
#include <numeric>

namespace cowgpu::test {
namespace {

RawMesh made(std::vector<Vec3> vertices, std::vector<Face> faces) {
  RawMesh mesh;
  mesh.name = "made";
  mesh.vertices = std::move(vertices);
  mesh.faces = std::move(faces);
  return mesh;
}

using Point = std::array<std::int64_t, 3>;

// Six times the volume of a, b, c, p: positive if p is on the outer side of the counter-clockwise face.
std::int64_t above(const Point& a, const Point& b, const Point& c, const Point& p) {
  Point u{}, v{}, w{};
  for (std::size_t k = 0; k < 3; ++k) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
    w[k] = p[k] - a[k];
  }
  return w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) + w[2] * (u[0] * v[1] - u[1] * v[0]);
}

// Puts one point after the other outside what there is; points in a face's plane see nothing of it.
std::vector<Face> convex_hull(const std::vector<Point>& p) {
  std::vector<Face> hull = {{0, 1, 2}, {0, 2, 1}};
  std::uint32_t fourth = 3;
  while (fourth < p.size() && above(p[0], p[1], p[2], p[fourth]) == 0) ++fourth;
  if (fourth == p.size()) return {};
  const bool up = above(p[0], p[1], p[2], p[fourth]) > 0;
  const std::uint32_t b = up ? 2 : 1, c = up ? 1 : 2;
  hull = {{0, b, c}, {b, 0, fourth}, {c, b, fourth}, {0, c, fourth}};
  for (std::uint32_t i = 3; i < p.size(); ++i) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> seen_edges;
    std::vector<Face> kept;
    for (const Face& f : hull) {
      if (above(p[f[0]], p[f[1]], p[f[2]], p[i]) <= 0) {
        kept.push_back(f);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) seen_edges[{f[k], f[(k + 1) % 3]}] = 1;
    }
    for (const auto& [edge, unused] : seen_edges)
      if (!seen_edges.contains({edge.second, edge.first})) kept.push_back({edge.first, edge.second, i});
    hull = std::move(kept);
  }
  return hull;
}

} // namespace

RawMesh box(const Vec3& sides, const Vec3& corner) {
  RawMesh mesh = made({}, {{0, 3, 2},
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
  for (const int z : {0, 1})
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)})
      mesh.vertices.push_back(corner + sides.cwiseProduct(Vec3(x, y, z)));
  return mesh;
}

RawMesh tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  RawMesh mesh = made({a, b, c, d}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
  return (d - a).dot((b - a).cross(c - a)) > 0 ? mesh : flipped(mesh);
}

RawMesh convex_polyhedron(std::mt19937& random, int points, int largest) {
  for (;;) {
    std::vector<Point> p(std::size_t(points), Point{});
    for (Point& x : p)
      for (std::int64_t& coordinate : x) coordinate = std::int64_t(random() % unsigned(2 * largest + 1)) - largest;
    const Point& o = p[0];
    const Point u = {p[1][0] - o[0], p[1][1] - o[1], p[1][2] - o[2]},
                v = {p[2][0] - o[0], p[2][1] - o[1], p[2][2] - o[2]};
    const bool collinear = u[0] * v[1] == u[1] * v[0] && u[1] * v[2] == u[2] * v[1] && u[2] * v[0] == u[0] * v[2];
    RawMesh mesh = made({}, collinear ? std::vector<Face>{} : convex_hull(p));
    if (mesh.faces.empty()) continue;
    for (const Point& x : p) mesh.vertices.emplace_back(double(x[0]), double(x[1]), double(x[2]));
    return mesh;
  }
}

RawMesh icosphere(int level, double radius) {
  const double g = std::numbers::phi;
  RawMesh mesh = made({{-1, g, 0},
                       {1, g, 0},
                       {-1, -g, 0},
                       {1, -g, 0},
                       {0, -1, g},
                       {0, 1, g},
                       {0, -1, -g},
                       {0, 1, -g},
                       {g, 0, -1},
                       {g, 0, 1},
                       {-g, 0, -1},
                       {-g, 0, 1}},
                      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}});
  for (int i = 0; i < level; ++i) mesh = split_midpoint(mesh);
  for (Vec3& v : mesh.vertices) v *= radius / v.norm();
  return mesh;
}

RawMesh torus(std::uint32_t n, std::uint32_t m, double ring_radius, double tube_radius) {
  RawMesh mesh = made({}, {});
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m;
      const double rho = ring_radius + tube_radius * std::cos(v);
      mesh.vertices.emplace_back(rho * std::cos(u), rho * std::sin(u), tube_radius * std::sin(v));
      const std::uint32_t a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m,
                          d = i * m + (j + 1) % m;
      mesh.faces.push_back({a, b, c});
      mesh.faces.push_back({a, c, d});
    }
  return mesh;
}

RawMesh two_shells() {
  const Eigen::Matrix3d tilt = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  return together(torus(9, 7), translated(rotated(torus(7, 5, 1, 0.4), tilt), {5, -1, 2}));
}

RawMesh shell_with_cavity() {
  return together(box({3, 2, 4}, {-1, -1, -2}), translated(flipped(icosphere(1, 0.6)), {0.3, 0.1, -0.5}));
}

RawMesh together(RawMesh mesh, const RawMesh& more) {
  const auto shift = std::uint32_t(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const Face& f : more.faces) mesh.faces.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
  return mesh;
}

RawMesh flipped(RawMesh mesh) {
  for (Face& f : mesh.faces) std::swap(f[1], f[2]);
  return mesh;
}

RawMesh translated(RawMesh mesh, const Vec3& shift) {
  for (Vec3& v : mesh.vertices) v += shift;
  return mesh;
}

RawMesh scaled(RawMesh mesh, const Vec3& factors) {
  for (Vec3& v : mesh.vertices) v = v.cwiseProduct(factors).eval();
  return mesh;
}

RawMesh rotated(RawMesh mesh, const Eigen::Matrix3d& rotation) {
  for (Vec3& v : mesh.vertices) v = (rotation * v).eval();
  return mesh;
}

RawMesh shuffled(RawMesh mesh, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::uint32_t> to(mesh.vertices.size());
  std::iota(to.begin(), to.end(), 0U);
  std::shuffle(to.begin(), to.end(), random);
  std::vector<Vec3> vertices(mesh.vertices.size());
  for (std::size_t v = 0; v < to.size(); ++v) vertices[to[v]] = mesh.vertices[v];
  mesh.vertices = std::move(vertices);
  for (Face& f : mesh.faces) {
    for (std::uint32_t& corner : f) corner = to[corner];
    std::rotate(f.begin(), f.begin() + random() % 3, f.end());
  }
  std::shuffle(mesh.faces.begin(), mesh.faces.end(), random);
  return mesh;
}

RawMesh some_faces(RawMesh mesh, std::size_t count, std::size_t stride) {
  std::vector<Face> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(mesh.faces[i * stride % mesh.faces.size()]);
  mesh.faces = std::move(chosen);
  return mesh;
}

std::optional<ClosedSurface> benchmark_cow() {
  const char* folder = std::getenv("COWGPU_MESHES");
  const std::filesystem::path here = std::filesystem::path(COWGPU_SOURCE) / "data" / "meshes";
  for (const auto& place : {std::filesystem::path(folder ? folder : ""), here}) {
    const std::filesystem::path path = place / "cow.off";
    if (place.empty() || !std::filesystem::exists(path)) continue;
    const std::string bytes = read_file(path);
    if (sha256_hex(bytes) == "8834713b505f9bf78c7f7c8b719d51d885d7d059952698da006813d292d84e95")
      return ClosedSurface::from(parse_off(bytes, "cow.off"));
  }
  return {};
}

void skip_without_cow() {
  std::cout << "SKIPPED: the benchmark mesh cow.off is not here; see data/meshes/README.md" << std::endl;
}

const std::vector<std::string> demo_bodies = {"armadillo", "bear",       "bull",  "bunny00",
                                              "camel",     "diplodocus", "homer", "triceratops"};

std::optional<ClosedSurface> demo_body(const std::string& name) {
  const char* folder = std::getenv("COWGPU_BODIES");
  const std::filesystem::path path = std::filesystem::path(folder ? folder : COWGPU_BODIES) / (name + ".off");
  if (!std::filesystem::exists(path)) return {};
  return ClosedSurface::from(parse_off(read_file(path), name));
}

void skip_without_bodies(const std::string& name) {
  std::cout << "SKIPPED: " << name << " of Debian's libcgal-demo is not in data/meshes/cgal; ./check fetches it" << std::endl;
}

} // namespace cowgpu::test
