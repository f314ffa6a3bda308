#include "host/io/ply_reader.hpp"

#include "host/io/sha256.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reader_checks.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

Outcome outcome(const std::string& bytes) {
  return outcome_of([&] { parse_ply(bytes, "x.ply"); });
}

const std::string triangle =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

} // namespace

TEST_CASE("PLY meshes read back in order from every encoding", "[ply-reader][readers]") {
  const RawMesh body = shuffled(icosphere(2, 0.3), 4);
  for (const std::string& bytes : {ply_text(body), ply_bytes(body, true, false), ply_bytes(body, true, true)}) {
    const RawMesh mesh = parse_ply(bytes, "folder/x.ply");
    CHECK(mesh.name == "folder/x.ply");
    CHECK(mesh.sha256 == sha256_hex(bytes));
    CHECK(mesh.vertices == body.vertices);
    CHECK(mesh.faces == body.faces);
    CHECK(mesh.notes.empty());
  }
  const RawMesh floats = rounded_to_floats(body);
  for (const bool big : {false, true}) CHECK(parse_ply(ply_bytes(body, false, big), "x").vertices == floats.vertices);
  CHECK(parse_ply(ply_text(body), "x").face_lines.front() == 10 + body.vertices.size());
  CHECK(parse_ply(ply_bytes(body, true, true), "x").face_lines.empty());
}

TEST_CASE("PLY text keeps the digits that it has, whatever type it announces", "[ply-reader][readers]") {
  CHECK(parse_ply(replaced(triangle, "1 0 0", "0.1 0 0"), "x").vertices[1].x() == 0.1);
}

TEST_CASE("convex PLY polygons become fans from their first corner", "[ply-reader][readers]") {
  const RawMesh mesh =
      parse_ply(replaced(replaced(triangle, "vertex 3", "vertex 4"), "3 0 1 2", "2 2 2\n4 3 0 1 2"), "x");
  CHECK(mesh.faces == std::vector<Face>{{3, 0, 1}, {3, 1, 2}});
  CHECK(mesh.face_lines == std::vector<std::uint32_t>{14, 14});
  CHECK(mesh.notes.at(0).starts_with("1 polygon "));
}

TEST_CASE("what of a PLY file is skipped is noted", "[ply-reader][readers]") {
  const std::string more = replaced(replaced(triangle, "element face", "property uchar red\nelement face"),
                                    "0 0 0\n1 0 0\n0 1 0", "0 0 0 9\n1 0 0 9\n0 1 0 9");
  CHECK(parse_ply(more, "x").notes == std::vector<std::string>{"Properties of the vertices were skipped: red."});
  const std::string edges =
      replaced(triangle, "end_header", "element edge 1\nproperty list uchar int vertices\nend_header") + "2 0 1\n";
  CHECK(parse_ply(edges, "x").notes == std::vector<std::string>{"Elements were skipped: edge."});
  CHECK(parse_ply(triangle + "\n more", "x").notes.at(0) == "Data after the last element were ignored (from line 15).");
  CHECK(parse_ply(ply_bytes(box({1, 1, 1}), false, true) + "abc", "x").notes.at(0).starts_with("3 bytes after"));
}

TEST_CASE("PLY headers are read with comments, empty lines and a byte order mark anywhere, and any line end",
          "[ply-reader][readers]") {
  const RawMesh body = rounded_to_floats(icosphere(0));
  const RawMesh expected = parse_ply(ply_bytes(body, false, false), "x");
  for (const std::string end : {"\n", "\r\n", "\r", "\n\r"})
    for (const std::string mark : {"", "\xef\xbb\xbf"})
      for (const bool binary : {true, false}) {
        const std::string plain = binary ? ply_bytes(body, false, false) : ply_text(body);
        std::string header = plain.substr(0, plain.find("end_header\n") + 11), data = plain.substr(header.size());
        header = replaced(header, "ply\n", "ply\ncomment first\n\nobj_info x\n  \n");
        header = replaced(header, "element face", "\ncomment more\nelement face");
        for (std::string* part : {&header, &data})
          if (part == &header || !binary)
            for (std::size_t at = 0; (at = part->find('\n', at)) != std::string::npos; at += end.size())
              part->replace(at, 1, end);
        const RawMesh mesh = parse_ply(mark + header + data, "x");
        INFO(binary << " " << int(end[0]) << " " << end.size());
        CHECK(mesh.vertices == (binary ? expected.vertices : body.vertices));
        CHECK(mesh.faces == expected.faces);
        CHECK(mesh.notes.empty());
        if (!binary) CHECK(mesh.face_lines.front() == 16 + body.vertices.size());
      }
}

TEST_CASE("PLY data may begin with a byte that is a line end", "[ply-reader][readers]") {
  const RawMesh body = box({1, 1, 1});
  for (const char first : {'\n', '\r'}) { // of the first coordinate, a double
    std::string bytes = ply_bytes(body, true, false);
    const std::size_t at = bytes.find("end_header\n") + 11;
    bytes[at] = first;
    const RawMesh expected = parse_ply(bytes, "x");
    CHECK(expected.faces == body.faces);
    for (const std::string end : {"\r", "\r\n", "\n\r"}) {
      if (end == "\r" && first == '\n') continue; // ambiguous only here
      std::string header = bytes.substr(0, at);
      for (std::size_t i = 0; (i = header.find('\n', i)) != std::string::npos; i += end.size())
        header.replace(i, 1, end);
      const RawMesh mesh = parse_ply(header + bytes.substr(at), "x");
      CHECK(mesh.vertices == expected.vertices);
      CHECK(mesh.faces == expected.faces);
    }
  }
}

TEST_CASE("PLY numbers of eight bytes are read, and refused by their value", "[ply-reader][readers]") {
  const auto file = [](const char* type, std::uint64_t last) {
    std::string bytes =
        fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty {0} x\nproperty {0} y\n"
                    "property {0} z\nelement face 1\nproperty list {0} {0} vertex_index\nend_header\n",
                    type);
    for (const std::uint64_t n :
         std::initializer_list<std::uint64_t>{0, 0, 0, 1, 0, 0, 0, 1ULL << 63, 0, 3, 0, 1, last})
      bytes.append(reinterpret_cast<const char*>(&n), 8);
    return bytes;
  };
  CHECK(parse_ply(file("uint64", 2), "x").vertices[2].y() == 0x1p63);
  CHECK(parse_ply(file("int64", 2), "x").vertices[2].y() == -0x1p63);
  CHECK(parse_ply(file("int64", 2), "x").faces == std::vector<Face>{{0, 1, 2}});
  CHECK(outcome(file("int64", 3)).fault == "mesh-index-range");
  CHECK(outcome(file("int64", ~0ULL)).says("names vertex -1"));
  CHECK(outcome(file("uint64", ~0ULL)).fault == "mesh-index-range");
  CHECK(outcome(file("int128", 2)).says("'int128' is not a type"));
}

TEST_CASE("PLY triangle strips become triangles, every second one turned, and -1 begins anew",
          "[ply-reader][readers]") {
  const auto strips = [](const std::string& lists, int count) {
    return parse_ply(
        "ply\nformat ascii 1.0\nelement tristrips " + std::to_string(count) +
            "\nproperty list int int vertex_indices\nelement vertex 6\nproperty float x\nproperty float y\n"
            "property float z\nend_header\n" +
            lists + "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n",
        "x.ply");
  };
  const std::vector<Face> expected = {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}};
  for (const char* lists : {"5 0 1 2 3 4\n", "6 0 1 2 3 4 -1\n", "7 -1 -1 0 1 2 3 4\n"})
    CHECK(strips(lists, 1).faces == expected);
  CHECK(strips("5 0 1 2 3 4\n", 1).notes == std::vector<std::string>{"1 triangle strip was cut into 3 triangles."});
  CHECK(strips("9 0 1 2 -1 2 1 3 -1 5\n", 1).faces == std::vector<Face>{{0, 1, 2}, {2, 1, 3}});
  CHECK(strips("3 0 1 2\n4 2 1 3 4\n", 2).faces == std::vector<Face>{{0, 1, 2}, {2, 1, 3}, {3, 1, 4}});
  // Two strips joined by triangles without area: 3 4 5 is the sixth triangle, and is turned.
  CHECK(strips("8 0 1 2 2 3 3 4 5\n", 1).faces == std::vector<Face>{{0, 1, 2}, {4, 3, 5}});
  CHECK(outcome_of([&] { strips("3 0 1 6\n", 1); }).says("a triangle strip names vertex 6"));
  CHECK(outcome_of([&] { strips("3 0 1 -2\n", 1); }).fault == "mesh-index-range");
}

TEST_CASE("PLY properties announced twice are read once, and names may have blanks", "[ply-reader][readers]") {
  const std::string twice =
      replaced(replaced(triangle, "element face", "property float y\nproperty int Distance (m)\nelement face"),
               "0 0 0\n1 0 0\n0 1 0", "0 0 0 7 8\n1 0 0 7 8\n0 1 0 7 8");
  const RawMesh mesh = parse_ply(twice, "x");
  CHECK(mesh.vertices == parse_ply(triangle, "x").vertices);
  CHECK(mesh.notes ==
        std::vector<std::string>{"Properties of the vertices were skipped: Distance (m).",
                                 "Announced more than once, and read where announced first: y of vertex."});
  CHECK(outcome(replaced(triangle, "property float y", "property float")).fault == "file-syntax");
  CHECK(outcome(replaced(triangle, "list uchar int", "list float int")).says("'float' is not a type of whole numbers"));
}

TEST_CASE("PLY faces of one and two corners are left out and counted", "[ply-reader][readers]") {
  const RawMesh mesh =
      parse_ply(replaced(replaced(triangle, "face 1", "face 3"), "3 0 1 2", "2 0 1\n3 0 1 2\n1 2"), "x");
  CHECK(mesh.faces == std::vector<Face>{{0, 1, 2}});
  CHECK(mesh.face_lines == std::vector<std::uint32_t>{14});
  CHECK(mesh.notes == std::vector<std::string>{"Left out, as they bound no volume: 1 line or face of two corners, "
                                               "1 point or face of one corner."});
  CHECK(outcome(replaced(triangle, "3 0 1 2", "0")).fault == "file-syntax");
}

TEST_CASE("PLY messages name file, line or byte, and what was found", "[ply-reader][readers]") {
  CHECK(outcome(replaced(triangle, "3 0 1 2", "3 0 1 7")).message.starts_with("x.ply:13: face 0 names vertex 7"));
  CHECK(outcome(replaced(triangle, "1 0 0", "1 zero 0")).message.starts_with("x.ply:11: "));
  CHECK(outcome(replaced(triangle, "1 0 0", "1 zero 0")).says("'zero'"));
  CHECK(outcome(replaced(triangle, "float y", "complex y")).message.starts_with("x.ply:5: "));
  CHECK(outcome(replaced(triangle, "float y", "float yy")).message.starts_with("x.ply:3: "));
  CHECK(outcome(replaced(triangle, "3 0 1 2", "3 0 1")).says("3 of 3 vertices and 0 of 1 faces"));
  const std::string bytes = ply_bytes(box({1, 1, 1}), false, false);
  CHECK(outcome(bytes.substr(0, bytes.size() - 1)).says("11 of 12 faces"));
  CHECK(outcome(bytes.substr(0, bytes.size() - 1)).says("at byte "));
}

TEST_CASE("PLY headers that promise too much cost no memory", "[ply-reader][readers]") {
  const std::string bytes = ply_bytes(box({1, 1, 1}), true, false);
  const std::size_t growth = peak_growth([&] {
    for (const char* what : {"vertex 8", "face 12"})
      outcome(replaced(bytes, what, std::string(what).substr(0, std::string(what).find(' ')) + " 4294967295"));
    outcome(replaced(triangle, "vertex 3", "vertex 4294967295"));
    outcome(replaced(triangle, "3 0 1 2", "4000000000 0 1 2"));
  });
  if (memory_is_measurable()) CHECK(growth < std::size_t{4} << 20);
}

TEST_CASE("PLY files with bytes changed are read or refused by name", "[ply-reader][readers]") {
  const auto read = [](std::string_view bytes) { parse_ply(bytes, "x.ply"); };
  const RawMesh body = tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  check_mutations(ply_text(body), 3000, read);
  check_mutations(ply_bytes(body, true, false), 3000, read);
  check_mutations(ply_bytes(body, false, true), 3000, read);
  check_prefixes(ply_bytes(body, false, true), read);
}

TEST_CASE("what is wrong with a PLY file from its first byte on is in line 1", "[ply]") {
  for (const std::string bytes : {"", "pl", "OFF\n"}) try {
      parse_ply(bytes, "x.ply");
      FAIL("taken");
    } catch (const Error& error) {
      CHECK_THAT(error.what(), Catch::StartsWith("x.ply:1: "));
    }
}
