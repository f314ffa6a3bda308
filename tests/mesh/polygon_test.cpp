#include "host/mesh/polygon.hpp"

#include "host/io/mesh_format.hpp"
#include "host/mesh/audit.hpp"
#include "host/mesh/polygon_sweep.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reader_checks.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numeric>
#include <random>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

using Polygon = std::vector<Vec3>;

// What a polygon is cut into, the fan written out.
std::vector<Face> triangles_of(const Polygon& polygon, PolygonCut expected) {
  PolygonCutter cutter;
  const CutPolygon cut = cutter.cut(polygon);
  REQUIRE(cut.result == expected);
  if (cut.result == PolygonCut::cut) return cutter.triangles();
  std::vector<Face> fan;
  for (std::uint32_t i = 1; i + 1 < polygon.size(); ++i) fan.push_back({0, i, i + 1});
  return fan;
}

double area(const Polygon& p, const Face& f) {
  return (p[f[1]] - p[f[0]]).cross(p[f[2]] - p[f[0]]).norm() / 2;
}

double area(const Polygon& p) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < p.size(); ++i) sum += (p[i] - p[0]).cross(p[(i + 1) % p.size()] - p[0]);
  return sum.norm() / 2;
}

// Triangles that, added up, have the polygon's edges in its sense, its area, and no part of it twice.
void check_cover(const Polygon& polygon, const std::vector<Face>& triangles) {
  const auto n = static_cast<std::uint32_t>(polygon.size());
  REQUIRE(triangles.size() == n - 2);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double sum = 0;
  for (const Face& f : triangles) {
    sum += area(polygon, f);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = f[k], b = f[(k + 1) % 3];
      ++edges[{a, b}], --edges[{b, a}];
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) --edges[{i, (i + 1) % n}], ++edges[{(i + 1) % n, i}];
  CHECK(std::all_of(edges.begin(), edges.end(), [](const auto& e) { return e.second == 0; }));
  // In one sense they all have positive areas, so that equal sums leave no overlap.
  CHECK(sum == Approx(area(polygon)).epsilon(1e-12));
}

Polygon turned(const Polygon& flat) {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).matrix();
  Polygon polygon;
  for (const Vec3& p : flat) polygon.push_back(rotation * p + Vec3(3, -2, 7));
  return polygon;
}

Polygon from_corner(Polygon polygon, std::size_t first, bool reversed) {
  std::rotate(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(first), polygon.end());
  if (reversed) std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

const Polygon u_shape = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};

// A comb of `teeth` prongs.
Polygon comb(std::uint32_t teeth) {
  Polygon polygon = {{0, 0, 0}, {double(teeth), 0, 0}};
  for (std::uint32_t t = teeth; t > 0; --t) {
    polygon.push_back({double(t), 5, 0});
    polygon.push_back({t - 0.5, 1, 0});
  }
  return polygon;
}

// As an OBJ, OFF and PLY file: a prism of height 1 over a polygon, with quadrilaterals round it.
RawMesh prism_vertices(const Polygon& polygon) {
  RawMesh mesh;
  for (const double z : {0., 1.})
    for (const Vec3& p : polygon) mesh.vertices.push_back({p.x(), p.y(), z});
  return mesh;
}

std::vector<std::vector<std::size_t>> prism_faces(std::size_t n) {
  std::vector<std::vector<std::size_t>> faces(2);
  for (std::size_t i = 0; i < n; ++i) faces[0].push_back(n - 1 - i), faces[1].push_back(n + i);
  for (std::size_t i = 0; i < n; ++i) faces.push_back({i, (i + 1) % n, (i + 1) % n + n, i + n});
  return faces;
}

std::vector<std::string> prism_files(const Polygon& polygon) {
  const RawMesh mesh = prism_vertices(polygon);
  const auto faces = prism_faces(polygon.size());
  std::string points, indices, obj;
  for (const Vec3& p : mesh.vertices) {
    const std::string line = fmt::format("{:.17g} {:.17g} {:.17g}\n", p.x(), p.y(), p.z());
    points += line, obj += "v " + line;
  }
  for (const auto& face : faces) {
    obj += "f";
    indices += std::to_string(face.size());
    for (const std::size_t v : face) indices += fmt::format(" {}", v), obj += fmt::format(" {}", v + 1);
    obj += "\n", indices += "\n";
  }
  const std::string ply = fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
                                      "property double z\nelement face {}\nproperty list uchar int vertex_indices\n"
                                      "end_header\n",
                                      mesh.vertices.size(), faces.size());
  return {obj, fmt::format("OFF\n{} {} 0\n", mesh.vertices.size(), faces.size()) + points + indices,
          ply + points + indices};
}

} // namespace

TEST_CASE("concave polygons of every format have their area", "[polygon][readers]") {
  Polygon star;
  for (int k = 0; k < 10; ++k)
    star.push_back(Vec3(std::cos(M_PI * k / 5), std::sin(M_PI * k / 5), 0) * (k % 2 == 0 ? 2 : 0.8));
  const Polygon teeth = comb(20);
  double length = 0;
  for (std::size_t i = 0; i < teeth.size(); ++i) length += (teeth[i] - teeth[(i + 1) % teeth.size()]).norm();
  const struct {
    Polygon polygon;
    double volume, area;
  } bodies[] = {{u_shape, 7, 30}, {star, 4.702282018, 23.726385213}, {teeth, area(teeth), 2 * area(teeth) + length}};
  for (const auto& body : bodies)
    for (const bool reversed : {false, true})
      for (std::size_t first = 0; first < body.polygon.size(); first += 3) {
        Polygon polygon = from_corner(body.polygon, first, false);
        if (reversed) // seen in a mirror, so that the prism's faces still look outwards
          for (Vec3& p : polygon = from_corner(polygon, 0, true)) p.x() = -p.x();
        for (const std::string& file : prism_files(polygon)) {
          const RawMesh mesh = parse_mesh(file, "x");
          const Audit facts = audit(mesh);
          INFO(first << file.substr(0, 3));
          CHECK((facts.closed && facts.consistently_oriented && facts.degenerate_faces == 0));
          CHECK(facts.volume.value() == Approx(body.volume).epsilon(1e-9));
          CHECK(facts.area == Approx(body.area).epsilon(1e-10));
          CHECK(facts.faces == 4 * polygon.size() - 4);
        }
      }
}

TEST_CASE("distances from a U prism of polygons are those of the body, and it has no overlaps",
          "[polygon][readers][cli]") {
  const TemporaryFolder folder;
  std::ofstream(folder / "u.obj") << prism_files(u_shape)[0];
  std::ofstream(folder / "points.csv") << "1.5,2,1.2\n1.5,2.5,1\n1.5,2,0.5\n0.5,0.5,0.9\n";
  const ProgramRun run =
      run_program({"distance", folder / "u.obj", folder / "points.csv", "-o", folder / "d.csv", "--device", "cpu"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  std::ifstream table(folder / "d.csv");
  std::vector<double> distances;
  for (std::string line; std::getline(table, line);)
    if (!line.starts_with('#') && !line.starts_with('x')) {
      std::size_t at = 0;
      for (int comma = 0; comma < 3; ++comma) at = line.find(',', at) + 1;
      distances.push_back(std::stod(line.substr(at)));
    }
  REQUIRE(distances.size() == 4);
  CHECK(distances[0] == Approx(std::sqrt(0.29)).epsilon(1e-15));
  CHECK(distances[1] == 0.5);
  CHECK(distances[2] == 0.5);
  CHECK(distances[3] == Approx(-0.1).epsilon(1e-14));
  const ProgramRun inspected = run_program({"inspect", folder / "u.obj", "--json"});
  CHECK(inspected.exit_code == 0);
  CHECK(inspected.out.find("\"area\": 30") != std::string::npos);
}

TEST_CASE("polygons in tilted planes are covered once from every first corner, in both senses", "[polygon]") {
  for (const Polygon& flat : {u_shape, comb(7)})
    for (std::size_t first = 0; first < flat.size(); ++first)
      for (const bool reversed : {false, true}) {
        const Polygon polygon = turned(from_corner(flat, first, reversed));
        PolygonCutter cutter;
        check_cover(polygon, triangles_of(polygon, cutter.cut(polygon).result));
      }
}

TEST_CASE("lattice polygons are cut exactly if brute force finds them simple", "[polygon]") {
  std::mt19937 random(3);
  const auto turn = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    const double det = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    return (det > 0) - (det < 0);
  };
  const auto within = [](const Vec3& a, const Vec3& b, const Vec3& p) { // p on the line through a and b
    return std::min(a.x(), b.x()) <= p.x() && p.x() <= std::max(a.x(), b.x()) && std::min(a.y(), b.y()) <= p.y() &&
           p.y() <= std::max(a.y(), b.y());
  };
  int simple_ones = 0, others = 0;
  for (int round = 0; round < 20000; ++round) {
    const std::size_t n = 4 + random() % 6;
    Polygon p;
    for (std::size_t i = 0; i < n; ++i) p.push_back({double(random() % 5), double(random() % 5), 0});
    bool simple = true;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j) {
        const Vec3 &a = p[i], &b = p[(i + 1) % n], &c = p[j], &d = p[(j + 1) % n];
        if (a == c) simple = false;
        if (j == i + 1 || (i == 0 && j == n - 1)) { // they share b = c, or a = d
          const Vec3 &shared = j == i + 1 ? b : a, &one = j == i + 1 ? a : b, &two = j == i + 1 ? d : c;
          if (turn(shared, one, two) == 0 && (one - shared).dot(two - shared) > 0) simple = false;
        } else {
          const int ta = turn(c, d, a), tb = turn(c, d, b), tc = turn(a, b, c), td = turn(a, b, d);
          if (ta * tb < 0 && tc * td < 0) simple = false;
          if ((ta == 0 && within(c, d, a)) || (tb == 0 && within(c, d, b)) || (tc == 0 && within(a, b, c)) ||
              (td == 0 && within(a, b, d)))
            simple = false;
        }
      }
    std::vector<std::uint32_t> corners(n);
    std::iota(corners.begin(), corners.end(), 0u);
    FlatPolygon flat(p, corners, 2, false);
    if (sense_of(flat) < 0) flat = FlatPolygon(p, corners, 2, true);
    std::vector<Face> triangles;
    const auto fault = sweep(flat, triangles);
    INFO(round << " " << n);
    REQUIRE(!fault == simple);
    (simple ? simple_ones : others)++;
    if (!simple) continue;
    check_cover(p, triangles);
    for (const Face& f : triangles) CHECK(area(p, f) > 0.4); // half a lattice square
    PolygonCutter cutter;
    const CutPolygon cut = cutter.cut(p);
    CHECK((cut.result == PolygonCut::fan || cut.result == PolygonCut::cut));
    check_cover(p, triangles_of(p, cut.result));
    for (const Face& f : triangles_of(p, cut.result)) CHECK(area(p, f) > 0.4);
  }
  CHECK(simple_ones > 1000);
  CHECK(others > 1000);
}

TEST_CASE("convex polygons stay fans from their first corner, thin, far and of many corners", "[polygon]") {
  for (const std::uint32_t n : {4u, 5u, 17u, 1000u})
    for (const double squeeze : {1., 1e-9}) {
      Polygon polygon;
      for (std::uint32_t i = 0; i < n; ++i) {
        const double angle = 2 * M_PI * (i + 0.3) / n;
        polygon.push_back({std::cos(angle), squeeze * std::sin(angle), 0});
      }
      triangles_of(polygon, PolygonCut::fan);
      if (squeeze == 1) triangles_of(turned(polygon), PolygonCut::fan);
    }
  const double e = 0x1p-50; // a wall as thick as four units in the last place
  triangles_of({{1, 0, 0}, {1 + e, 0, 0}, {1 + e, 0, 1}, {1, 0, 1}}, PolygonCut::fan);
  triangles_of({{1e9, 0, 0}, {1e9 + 1, 0, 0}, {1e9 + 1, 1, 0}, {1e9, 1, 0}}, PolygonCut::fan);
}

TEST_CASE("corners on an edge leave no triangle without area, rounded ones included", "[polygon]") {
  // A square with 9 corners more on each side, from every first corner.
  Polygon flat;
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < 10; ++i) {
      const double t = i / 10.;
      flat.push_back(side == 0   ? Vec3(t, 0, 0)
                     : side == 1 ? Vec3(1, t, 0)
                     : side == 2 ? Vec3(1 - t, 1, 0)
                                 : Vec3(0, 1 - t, 0));
    }
  for (std::size_t first = 0; first < 40; first += 3)
    for (const Polygon& polygon : {from_corner(flat, first, false), turned(from_corner(flat, first, true))}) {
      const std::vector<Face> triangles = triangles_of(polygon, PolygonCut::cut);
      check_cover(polygon, triangles);
      for (const Face& f : triangles) CHECK(area(polygon, f) > 1e-3); // of the 40-th part of the square each
    }
}

TEST_CASE("corners at one place keep a polygon closed", "[polygon]") {
  const Polygon pole = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 1, 0}};
  triangles_of(pole, PolygonCut::fan);
  Polygon doubled;
  for (const Vec3& p : u_shape) doubled.insert(doubled.end(), {p, p, p});
  for (const std::size_t first : {0, 1, 2}) {
    const Polygon polygon = from_corner(doubled, first, false);
    check_cover(polygon, triangles_of(polygon, PolygonCut::cut));
  }
  triangles_of({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 0, 0}}, PolygonCut::fan); // a quadrilateral that collapsed
}

TEST_CASE("polygons that are not simple are refused with the place", "[polygon]") {
  PolygonCutter cutter;
  const auto cut = [&](const Polygon& p) { return cutter.cut(p); };
  for (const double bottom : {1., 0.7}) { // a bow tie, with and without an area vector
    const CutPolygon tie = cut({{0, 0, 0}, {1, 1, 0}, {bottom, 0, 0}, {0, 1, 0}});
    CHECK(tie.result == PolygonCut::crosses);
    CHECK(tie.at == std::array<std::uint32_t, 2>{0, 2});
  }
  Polygon pentagram;
  for (int i = 0; i < 5; ++i) pentagram.push_back({std::cos(4 * M_PI * i / 5), std::sin(4 * M_PI * i / 5), 0});
  CHECK(cut(pentagram).result == PolygonCut::crosses);
  Polygon twice; // round a square twice
  for (int i = 0; i < 8; ++i) twice.push_back(Vec3(std::cos(M_PI * i / 2), std::sin(M_PI * i / 2), 0) * (1 + 0.01 * i));
  CHECK(cut(twice).result == PolygonCut::crosses);
  const CutPolygon touching = cut({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}});
  CHECK(touching.result == PolygonCut::touches);
  CHECK(touching.at == std::array<std::uint32_t, 2>{2, 5});
  CHECK(cut({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0, 0}, {0, 2, 0}}).result == PolygonCut::crosses); // touches an edge
  CHECK(cut({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2, 1, 0}, {0, 1, 0}}).result == PolygonCut::crosses); // turns back
  CHECK(cut({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}).result == PolygonCut::no_plane);
  CHECK(cut({{1, 0, 0}, {1, 1, 1}, {1, 0.1, 0.1}, {1, 0.7, 0.7}, {1, 0.3, 0.3}}).result == PolygonCut::no_plane);
  Polygon folded = u_shape;
  folded[6].z() = 3, folded[1].z() = -3;
  folded[6].x() = 4;
  CHECK(cut(folded).result == PolygonCut::no_plane);
}

TEST_CASE("bent polygons are cut as they look from above, and measured", "[polygon][readers]") {
  PolygonCutter cutter;
  Polygon bent = u_shape;
  CHECK(cutter.cut(bent).bend == 0);
  bent[2].z() = 0.03;
  const CutPolygon cut = cutter.cut(bent);
  CHECK(cut.result == PolygonCut::cut);
  CHECK(cut.bend == Approx(0.004).epsilon(0.5)); // half of 0.03 at one corner of an extent of 3
  check_cover(u_shape, cutter.triangles());
  // A saddle, today's fan; one folded back upon itself, the same.
  CHECK(cutter.cut(Polygon{{0, 0, 0}, {1, 0, 1}, {1, 1, 0}, {0, 1, 1}}).result == PolygonCut::fan);
  CHECK(cutter.cut(Polygon{{0, 0, 0}, {1, 0, 0}, {0.9, 0.1, 1}, {0.1, 0.05, 0.02}}).result != PolygonCut::crosses);
  RawMesh prism;
  std::string file = prism_files(u_shape)[0];
  const RawMesh mesh = parse_mesh(replaced(file, "v 3 3 0", "v 3 3 0.03"), "x.obj");
  REQUIRE(mesh.notes.size() == 2);
  CHECK(mesh.notes[0] ==
        "10 polygons of more than three corners were cut into triangles, fans from the first corner, but for "
        "2 whose fan would overlap itself or have parts without area.");
  CHECK(mesh.notes[1].starts_with("1 polygon of more than three corners is not flat (corners up to 0.0"));
}

TEST_CASE("a polygon of 100,000 corners takes a bounded number of steps and bytes", "[alone][polygon]") {
  const Polygon polygon = comb(50000);
  std::vector<Face> triangles;
  const std::size_t growth = peak_growth([&] { triangles = triangles_of(polygon, PolygonCut::cut); });
  CHECK(triangles_of(polygon, PolygonCut::cut).size() == polygon.size() - 2);
  if (memory_is_measurable()) CHECK(growth < 400 * polygon.size());
}

TEST_CASE("readers name the polygon that they refuse", "[polygon][readers]") {
  const std::string obj = prism_files(u_shape)[0];
  const auto refusal = [](const std::string& file) { return outcome_of([&] { parse_mesh(file, "x"); }); };
  const Outcome crossing = refusal(replaced(obj, "f 8 7 6 5 4 3 2 1", "f 8 7 4 5 6 3 2 1"));
  CHECK(crossing.fault == "file-syntax");
  CHECK(crossing.says(
      "x:17: the polygon of 8 corners, vertices 8, 7, 4, 5, 6, 3 ..., crosses itself: its edges 4-5 and 6-3 meet"));
  const Outcome twice = refusal(replaced(obj, "f 8 7 6 5 4 3 2 1", "f 8 7 6 5 4 6 3 2 1"));
  CHECK(twice.says("names vertex 6 twice"));
  const Outcome many = refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 1 2 3 1 2 3\n");
  CHECK(many.says("names vertex 1 twice"));
  CHECK(refusal(obj + "v 3 3 0.25\nv 3 3 0.5\nf 3 17 18 11\n").says("has no plane: its corners lie on a line"));
  // A vertex named twice in a row is named once.
  const RawMesh mesh = parse_mesh(
      replaced(replaced(obj, "f 8 7 6 5 4 3 2 1", "f 8 8 7 6 5 4 3 3 2 1 8"), "f 1 2 10 9", "f 1 2 10 9\nf 1 1 2 2"),
      "x");
  CHECK(mesh.faces.size() == 28);
  CHECK(mesh.face_lines.size() == 28);
  CHECK(mesh.notes ==
        std::vector<std::string>{
            "11 polygons of more than three corners were cut into triangles, fans from the first corner, but "
            "for 2 whose fan would overlap itself or have parts without area.",
            "5 corners of polygons named the vertex of the corner before and were left out.",
            "Left out, as they bound no volume: 1 line or face of two corners."});
}
