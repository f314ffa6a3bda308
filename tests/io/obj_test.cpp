#include "host/io/obj.hpp"

#include "host/io/sha256.hpp"
#include "tests/support/reader_checks.hpp"

#include <catch2/catch.hpp>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

Outcome outcome(const std::string& text) {
  return outcome_of([&] { parse_obj(text, "x.obj"); });
}

} // namespace

TEST_CASE("an OBJ mesh is read as it stands in the file", "[obj][readers]") {
  const RawMesh mesh = parse_obj(tetrahedron, "folder/x.obj");
  CHECK(mesh.name == "folder/x.obj");
  CHECK(mesh.sha256 == sha256_hex(tetrahedron));
  CHECK(mesh.vertices == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  CHECK(mesh.faces == std::vector<Face>{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
  CHECK(mesh.face_lines == std::vector<std::uint32_t>{5, 6, 7, 8});
  CHECK(mesh.notes.empty());
}

TEST_CASE("OBJ vertices at one point stay apart", "[obj][readers]") {
  const RawMesh mesh = parse_obj("v 1 2 3\nv 1 2 3\nv 0 0 0\nf 1 3 2\n", "x.obj");
  CHECK(mesh.vertices.size() == 3);
  CHECK(mesh.faces == std::vector<Face>{{0, 2, 1}});
}

TEST_CASE("OBJ indices count from one, or backwards from the last vertex above", "[obj][readers]") {
  const RawMesh mesh =
      parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -1 1 -2\nf 5 4 3\nv 7 7 7\n", "x.obj");
  CHECK(mesh.faces == std::vector<Face>{{0, 1, 2}, {3, 0, 2}, {4, 3, 2}});
}

TEST_CASE("OBJ corners take textures and normals in every form", "[obj][readers]") {
  const std::vector<Face> faces = parse_obj(tetrahedron, "x").faces;
  for (const char* form : {"1/7 3/8 2/9", "1//7 3//8 2//9", "1/7/8 3/9/1 2/1/1", "1/-1/-1 3/-1 2", "1/ 3/ 2//"})
    CHECK(parse_obj(replaced(tetrahedron, "1 3 2", form), "x").faces == faces);
  for (const char* form : {"1/7/8/9 3 2", "/1 3 2", "1/x 3 2", "1/1.5 3 2", "1,3,2", "1.0 3 2"}) {
    INFO(form);
    CHECK(outcome(replaced(tetrahedron, "1 3 2", form)).fault == "file-syntax");
  }
}

TEST_CASE("convex OBJ polygons become fans from their first corner and keep the line they begin on", "[obj][readers]") {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\n";
  for (const char* face :
       {"f 4 5 1 2 3\nf 1 2 3\n", "f 4 5 \\\n 1\\\n2 3\nf 1 2 3\n", "fo 4 5 1 2 3 # \\\nf 1 2 3\n"}) {
    const RawMesh mesh = parse_obj(points + face, "x.obj");
    CHECK(mesh.faces == std::vector<Face>{{3, 4, 0}, {3, 0, 1}, {3, 1, 2}, {0, 1, 2}});
    CHECK(mesh.face_lines[0] == 6);
    CHECK(mesh.face_lines[2] == 6);
    CHECK(mesh.face_lines[3] == (std::string(face).find("\\\n ") == std::string::npos ? 7 : 9));
    REQUIRE(mesh.notes.size() == 1);
    CHECK(mesh.notes[0].starts_with("1 polygon "));
  }
}

TEST_CASE("weights of OBJ vertices do not move them, as the format has it", "[obj][readers]") {
  const RawMesh mesh = parse_obj("v 1 2 3 0\nv 1 2 4 2\nv 1 3 3 1\nv 0 0 0\nf 1 2 3\n", "x.obj");
  CHECK(mesh.vertices[0] == Vec3(1, 2, 3));
  CHECK(mesh.vertices[1] == Vec3(1, 2, 4));
  REQUIRE(mesh.notes.size() == 1);
  CHECK(mesh.notes[0].starts_with("2 vertices have a weight"));
}

TEST_CASE("what of an OBJ file is skipped is noted", "[obj][readers]") {
  const RawMesh mesh = parse_obj("mtllib a.mtl\no body # one\n" + tetrahedron +
                                     "g x y\nl 1 2\nl 2/1 3/1 \\\n 4/1\nf 1 2\np 1\nvt 0\nvn 0 0 1\ns 1\n",
                                 "x");
  CHECK(mesh.notes ==
        std::vector<std::string>{
            "Left out, as they bound no volume: 3 lines or faces of two corners, 1 point or face of one corner."});
  for (const char* colour : {"v 0 0 0 1 0.5 0\n", "v 0 0 0 1 0.5 0 1\n"})
    CHECK(parse_obj(colour + tetrahedron, "x").notes ==
          std::vector<std::string>{"Colours of the vertices were skipped."});
}

TEST_CASE("unknown OBJ statements are skipped with their names, broken lines are not", "[obj][readers]") {
  const RawMesh mesh = parse_obj("Kd 0.5 0.5 0.5\n" + tetrahedron + "newmtl \\\n f 1 2 3\nKd 0 0 0\n", "x.obj");
  CHECK(mesh.faces.size() == 4);
  CHECK(mesh.notes == std::vector<std::string>{"3 statements that OBJ does not have were skipped: Kd, newmtl."});
  for (const char* line : {"1 2 3\n", "-1 2 3\n", "V 1 2 3\n", "F 1 2 3\n", "\x1b[31m\n"})
    CHECK(outcome(line + tetrahedron).fault == "file-syntax");
  CHECK(outcome("hello\nworld 1 2 3\n").fault == "file-format");
  CHECK(outcome("hello\nworld 1 2 3\n").says("'hello', 'world'"));
}

TEST_CASE("a backslash joins lines in every OBJ statement, and in no comment", "[obj][readers]") {
  const std::vector<Face> faces = parse_obj(tetrahedron, "x").faces;
  for (const char* ends : {"\n", "\r\n", "\r", "\n\r", " \n", "\t \r\n"})
    for (const char* statement : {"g a", "vn 0 0", "vt 0", "o", "usemtl", "s", "mtllib x", "l 1 2", "p 1", "unknown"}) {
      const std::string text =
          replaced(tetrahedron, "f 1 3 2", statement + std::string(" \\") + ends + "f 1 2 3\nf 1 3 2");
      INFO(text);
      CHECK(parse_obj(text, "x").faces == faces);
    }
  CHECK(parse_obj(replaced(tetrahedron, "f 1 3 2", "# \\\nf 1 3 2"), "x").faces == faces);
  CHECK(parse_obj(replaced(tetrahedron, "f 1 3 2", "g a # \\\nf 1 3 2"), "x").faces == faces);
  CHECK(parse_obj(replaced(tetrahedron, "f 1 3 2", "g a\\b\nf 1 3 2"), "x").faces == faces);
  CHECK(parse_obj(replaced(tetrahedron, "f 1 3 2", "f 1\\  \n 3 \\\n\\\n 2"), "x").faces == faces);
  CHECK(parse_obj(tetrahedron + "g \\", "x").faces == faces);
  // At the end of the file it joins nothing.
  const std::string whole = tetrahedron.substr(0, tetrahedron.find_last_not_of(" \n") + 1);
  for (const char* end : {"\\", " \\", "\\\n", " \\ "}) CHECK(parse_obj(whole + end, "x").faces == faces);
}

TEST_CASE("OBJ faces are counted from zero where they name vertex 0 and all are there", "[obj][readers]") {
  const std::string from_zero = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 0 2 1\nf 0 1 3\nf 1 2 3\nf 0 3 2\n";
  const RawMesh mesh = parse_obj(from_zero, "x.obj");
  CHECK(mesh.faces == parse_obj(tetrahedron, "x").faces);
  REQUIRE(mesh.notes.size() == 1);
  CHECK(mesh.notes[0].find("numbered from 0") != std::string::npos);
  CHECK(
      outcome(from_zero + "f 1 2 4\n").message.starts_with("x.obj:5: face 0 names vertex 0, but there are 4 vertices"));
  CHECK(outcome(from_zero + "f 1 2 x\n").fault == "file-syntax");
  CHECK(outcome("f 0 0 0\n").fault == "mesh-index-range");
}

TEST_CASE("OBJ messages name file, line, face and what was found", "[obj][readers]") {
  CHECK(outcome(replaced(tetrahedron, "f 2 3 4", "f 2 3 9")).message.starts_with("x.obj:7: face 2 names vertex 9"));
  CHECK(outcome(replaced(tetrahedron, "f 2 3 4", "f 2 3 0")).fault == "mesh-index-range");
  CHECK(outcome(replaced(tetrahedron, "f 2 3 4", "f 2 3 -5")).says("4 vertices stand above"));
  CHECK(outcome(replaced(tetrahedron, "v 1 0 0", "v 1 zero 0")).message.starts_with("x.obj:2: "));
  CHECK(outcome(replaced(tetrahedron, "v 1 0 0", "v 1 zero 0")).says("'zero'"));
  CHECK(outcome(replaced(tetrahedron, "f 2 3 4", "surf 0 1 0 1 1")).says("'surf'"));
  CHECK(outcome(replaced(tetrahedron, "f 2 3 4", "\x1b[31m 3")).fault == "file-syntax");
  CHECK(outcome(replaced(tetrahedron, "f 2 3 4", "\x1b[31m 3")).message.find('\x1b') == std::string::npos);
  CHECK(outcome(tetrahedron.substr(0, 20)).fault == "file-truncated");
  CHECK(outcome(tetrahedron.substr(0, tetrahedron.size() - 3)).fault == "file-truncated"); // within a face
}

TEST_CASE("OBJ files with bytes changed are read or refused by name", "[obj][readers]") {
  check_mutations(tetrahedron + "f 1/2/3 2//3 3/1 \\\n -1\nl 1 2\nvt 0 0\n", 5000,
                  [](std::string_view bytes) { parse_obj(bytes, "x.obj"); });
}
