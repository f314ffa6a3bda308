#include "host/io/stl.hpp"

#include "host/mesh/closed_surface.hpp"
#include "host/mesh/geometry.hpp"
#include "host/mesh/weld.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reader_checks.hpp"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstring>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

Outcome outcome(const std::string& bytes) {
  return outcome_of([&] { parse_stl(bytes, "x.stl"); });
}

/// The corners of the faces, one after another.
std::vector<Vec3> corners(const RawMesh& mesh) {
  std::vector<Vec3> points;
  for (const Face& f : mesh.faces)
    for (const std::uint32_t v : f) points.push_back(mesh.vertices[v]);
  return points;
}

std::string facet(const char* a, const char* b, const char* c, const char* normal = "0 0 0") {
  return std::string("facet normal ") + normal + " outer loop vertex " + a + " vertex " + b + " vertex " + c +
         " endloop endfacet\n";
}

} // namespace

TEST_CASE("STL facets keep their order and their corners, which are welded", "[stl][readers]") {
  const RawMesh body = rounded_to_floats(shuffled(icosphere(2), 3));
  for (const std::string& bytes : {stl_text(body), stl_bytes(body), stl_bytes(body, "solid body")}) {
    const RawMesh mesh = parse_stl(bytes, "x.stl");
    CHECK(corners(mesh) == corners(body));
    CHECK(mesh.vertices.size() == body.vertices.size());
    REQUIRE(mesh.notes.size() == 1);
    CHECK(mesh.notes[0].find("960 corners of 320 facets were welded into 162 vertices") != std::string::npos);
    CHECK(outcome_of([&] { ManifoldSurface::from(ClosedSurface::from(mesh)); }).fault == "none");
  }
  const RawMesh text = parse_stl(stl_text(body), "x.stl");
  CHECK(text.face_lines[1] == 9);
  CHECK(parse_stl(stl_bytes(body), "x.stl").face_lines.empty());
}

TEST_CASE("ASCII STL coordinates are doubles", "[stl][readers]") {
  const RawMesh mesh = parse_stl("solid\n" + facet("0.1 1e-300 5e-324", "1 0 0", "0 1 0") + "endsolid", "x");
  CHECK(mesh.vertices[0] == Vec3(0.1, 1e-300, 5e-324));
}

TEST_CASE("only exactly equal corners are welded, zeros of both signs among them", "[stl][weld][readers]") {
  const RawMesh mesh = parse_stl("solid\n" + facet("0 0 0", "1 0 0", "0 1 0") +
                                     facet("-0 0 -0", "1.0000000000000002 0 0", "0 1 0") + "endsolid",
                                 "x");
  CHECK(mesh.faces == std::vector<Face>{{0, 1, 2}, {0, 3, 2}});
  CHECK(!std::signbit(mesh.vertices[0].x()));
  std::vector<Vec3> points;
  PointWelder welder(points);
  for (int i = 0; i < 10000; ++i) CHECK(welder.index(Vec3(i, 0, -i)) == std::uint32_t(i));
  for (int i = 0; i < 10000; ++i) CHECK(welder.index(Vec3(i, -0.0, -i)) == std::uint32_t(i));
  CHECK(points.size() == 10000);
}

TEST_CASE("welding keeps the order of vertices and leaves out what loses its area", "[weld]") {
  RawMesh mesh;
  mesh.vertices = {{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  mesh.faces = {{0, 1, 3}, {2, 4, 3}, {0, 2, 3}, {1, 1, 3}};
  mesh.face_lines = {5, 6, 7, 8};
  const Weld weld = weld_equal_points(mesh);
  CHECK(weld.merged == 2);
  CHECK(weld.collapsed == 1);
  CHECK(mesh.vertices == std::vector<Vec3>{{1, 0, 0}, {0, 0, 0}, {0, 1, 0}});
  CHECK(mesh.faces == std::vector<Face>{{0, 1, 2}, {0, 1, 2}, {1, 1, 2}});
  CHECK(mesh.face_lines == std::vector<std::uint32_t>{5, 6, 8});
}

TEST_CASE("a sum of hashes tells closed meshes from others", "[weld]") {
  for (const RawMesh& body : {icosphere(2), torus(7, 5), two_shells(), box({1, 2, 3})}) {
    CHECK(seems_balanced(body.faces));
    for (std::size_t f = 0; f < body.faces.size(); f += 7) {
      auto faces = body.faces;
      std::swap(faces[f][0], faces[f][1]);
      CHECK(!seems_balanced(faces));
      faces.erase(faces.begin() + std::ptrdiff_t(f));
      CHECK(!seems_balanced(faces));
    }
  }
}

TEST_CASE("STL facets without area are left out and counted", "[stl][readers]") {
  const RawMesh mesh =
      parse_stl("solid\n" + facet("0 0 0", "1 0 0", "0 1 0") + facet("0 0 0", "0 0 -0", "0 1 0") + "endsolid", "x");
  CHECK(mesh.faces.size() == 1);
  REQUIRE(mesh.notes.size() == 2);
  CHECK(mesh.notes[1].starts_with("Facets with two corners at one point were left out: 1."));
}

TEST_CASE("STL normals do not count, and are noted where they contradict the corners", "[stl][readers]") {
  const std::string against = facet("0 0 0", "1 0 0", "0 1 0", "0 0 -1"),
                    along = facet("0 0 0", "1 0 0", "0 1 0", "0 0 1");
  CHECK(parse_stl("solid\n" + along + "endsolid", "x").notes.size() == 1);
  CHECK(parse_stl("solid\n" + facet("0 0 0", "1 0 0", "0 1 0", "-nan(ind) x 1") + "endsolid", "x").notes.size() == 1);
  const RawMesh mesh = parse_stl("solid\n" + along + against + "endsolid", "x");
  CHECK(mesh.faces[0] == mesh.faces[1]);
  CHECK(mesh.notes.at(1).find("1 of 2 facets look against") != std::string::npos);
}

TEST_CASE("binary STL that begins with solid is binary, and its attributes and trailing bytes are noted",
          "[stl][readers]") {
  std::string bytes = stl_bytes(box({1, 2, 3}), "solid ascii");
  CHECK(looks_like_binary_stl(bytes));
  CHECK(!looks_like_binary_stl(stl_text(box({1, 2, 3}))));
  bytes[84 + 49] = '\x7f';
  const RawMesh mesh = parse_stl(bytes + "tail", "x.stl");
  CHECK(mesh.faces.size() == 12);
  CHECK(mesh.notes.at(0).starts_with("Attribute bytes"));
  CHECK(mesh.notes.at(1) == "4 bytes after the last facet were ignored (from byte 684).");
}

TEST_CASE("STL messages name file, line or byte, and what was found", "[stl][readers]") {
  const std::string text = stl_text(box({1, 1, 1}));
  CHECK(outcome(replaced(text, "outer loop", "outer lop"))
            .message.starts_with("x.stl:3: 'loop' expected after 0 facets, found 'lop'"));
  CHECK(outcome(replaced(text, "vertex ", "vertex x")).fault == "file-syntax");
  CHECK(outcome(text.substr(0, text.size() - 20)).fault == "file-truncated");
  CHECK(outcome(text.substr(0, text.rfind("endsolid") + 4)).says("the file ends after 12 facets, before 'endsolid'"));
  CHECK(outcome(replaced(text, "endloop", "end lop")).says("'endloop' expected"));
  CHECK(outcome(text + "rest").fault == "file-truncated"); // perhaps the beginning of a word
  CHECK(outcome(text + "rest of it\n").fault == "file-syntax");
  const std::string bytes = stl_bytes(box({1, 1, 1}));
  CHECK(outcome(bytes.substr(0, 300)).says("at byte 300: the file ends after 4 of 12 facets"));
  CHECK(outcome("off\n").fault == "file-format");
}

TEST_CASE("STL without endsolid is read where its last facet is whole, and says so", "[stl][readers]") {
  const std::string text = stl_text(box({1, 1, 1}));
  const RawMesh mesh = parse_stl(text.substr(0, text.rfind("endsolid")), "x.stl");
  CHECK(mesh.faces.size() == 12);
  CHECK(mesh.notes.at(0).find("'endsolid' is missing after 12 facets") != std::string::npos);
  CHECK(outcome("solid x\n").fault == "file-truncated");
  const RawMesh two = parse_stl(replaced(text, "endsolid", "solid 2\nendsolid"), "x.stl");
  CHECK(two.notes.at(0).find("'endsolid' is missing") != std::string::npos);
}

TEST_CASE("a solid of STL may be named like a facet", "[stl][readers]") {
  const std::string body = stl_text(box({1, 2, 3}));
  const std::vector<Vec3> expected = corners(parse_stl(body, "x"));
  REQUIRE(expected.size() == 36);
  const std::string from = body.find('\n') == std::string::npos ? body : body.substr(body.find('\n'));
  const std::string facets = from.substr(0, from.rfind("endsolid"));
  for (const char* name :
       {"facet normal 1", "a facet normal", "facet normal 0 0 1", "facet", "facet normal facet normal"}) {
    INFO(name);
    CHECK(corners(parse_stl("solid " + std::string(name) + facets + "endsolid " + name + "\n", "x")) == expected);
  }
  // On the line of the word solid facets begin all the same.
  CHECK(parse_stl("solid a " + facet("0 0 0", "1 0 0", "0 1 0") + "endsolid", "x").faces.size() == 1);
  CHECK(parse_stl(
            "solid a facet normal 0 0 1\nouter loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet endsolid",
            "x")
            .faces.size() == 1);
}

TEST_CASE("STL comments and colours are skipped and counted", "[stl][readers]") {
  const std::string text = replaced(stl_text(box({1, 1, 1})), "outer loop", "color 1 0 0\nouter loop # its corners");
  const RawMesh mesh = parse_stl("# who made it\n" + text, "x.stl");
  CHECK(mesh.faces.size() == 12);
  CHECK(mesh.notes.at(1).find("comments and colours were skipped") != std::string::npos);
}

TEST_CASE("binary STL that announces no facets is read by its length", "[stl][readers]") {
  std::string bytes = stl_bytes(box({1, 2, 3}));
  bytes.replace(80, 4, 4, '\0');
  const RawMesh mesh = parse_stl(bytes, "x.stl");
  CHECK(mesh.faces.size() == 12);
  CHECK(mesh.notes.at(0).starts_with("The header announces 0 facets, but 600 bytes follow: 12 facets were read"));
  CHECK(outcome(bytes.substr(0, bytes.size() - 7)).says("announces 0 facets, and 593 bytes follow"));
  CHECK(parse_stl(bytes.substr(0, 84), "x.stl").faces.empty());
}

TEST_CASE("STL files with bytes changed are read or refused by name", "[stl][readers]") {
  const auto read = [](std::string_view bytes) { parse_stl(bytes, "x.stl"); };
  check_mutations(stl_text(tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})), 3000, read);
  check_mutations(stl_bytes(tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})), 3000, read);
  check_prefixes(stl_bytes(box({1, 1, 1}), "solid"), read);
}

TEST_CASE("welded shells that touch along an edge have a volume but no map", "[stl][readers]") {
  const RawMesh touching = together(box({1, 2, 3}), box({1, 1, 3}, {1, 2, 0}));
  CHECK(outcome_of([&] { ManifoldSurface::from(ClosedSurface::from(touching)); }).fault == "none"); // not welded
  const ClosedSurface welded = ClosedSurface::from(parse_stl(stl_bytes(touching), "x.stl"));
  CHECK(welded.vertices().size() == 14);
  CHECK(volume(welded) == 9);
  const Outcome map = outcome_of([&] { ManifoldSurface::from(welded); });
  CHECK(map.fault == "mesh-edge-manifold");
  CHECK(map.says("1 edge"));
}
