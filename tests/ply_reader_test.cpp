#include "host/io/ply_reader.hpp"

#include "host/io/sha256.hpp"
#include "tests/support/mesh_files.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reader_checks.hpp"

#include <catch2/catch.hpp>

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

TEST_CASE("PLY polygons become fans from their first corner", "[ply-reader][readers]") {
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
