#include "host/io/off.hpp"

#include "host/error.hpp"
#include "host/io/sha256.hpp"
#include "tests/support/reader_checks.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <sys/resource.h>

using namespace cowgpu;
using test::replaced;

namespace {

std::string fault_of(const std::function<void()>& work) {
  return test::outcome_of(work).fault;
}

std::string message_of(const std::string& text) {
  try {
    parse_off(text, "x.off");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

const std::string tetrahedron = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

} // namespace

TEST_CASE("prefixes that lack a face are truncated", "[off]") {
  const std::size_t last_face = tetrahedron.rfind("3 0 3 2");
  for (std::size_t size = 4; size < last_face + 6; ++size) {
    INFO(size);
    CHECK(fault_of([&] { parse_off(tetrahedron.substr(0, size), "x.off"); }) == "file-truncated");
  }
}

TEST_CASE("false counts cost no memory", "[off]") {
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  for (const char* counts : {"4294967295 4 6", "4 4294967295 6", "4294967295 4294967295 6", "4294967296 4 6"}) {
    INFO(counts);
    const std::string fault = fault_of([&] { parse_off(replaced(tetrahedron, "4 4 6", counts), "x.off"); });
    CHECK((fault == "file-truncated" || fault == "file-syntax" || fault == "mesh-index-range"));
  }
  CHECK(fault_of([&] { parse_off(replaced(tetrahedron, "3 0 2 1", "4000000000 0 2 1"), "x.off"); }) ==
        "file-truncated");
  getrusage(RUSAGE_SELF, &after);
  CHECK(after.ru_maxrss - before.ru_maxrss < 16 * 1024); // KiB
}

TEST_CASE("a mesh is read as it stands in the file", "[off]") {
  const RawMesh mesh = parse_off(tetrahedron, "folder/x.off");
  CHECK(mesh.name == "folder/x.off");
  CHECK(mesh.sha256 == sha256_hex(tetrahedron));
  CHECK(mesh.vertices == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  CHECK(mesh.faces == std::vector<Face>{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
  CHECK(mesh.face_lines == std::vector<std::uint32_t>{7, 8, 9, 10});
  CHECK(mesh.notes.empty());
}

TEST_CASE("numbers are read to the last bit", "[off]") {
  const std::vector<std::pair<std::string, double>> cases = {{"0.1", 0.1},
                                                             {"+0.1", 0.1},
                                                             {"-.5", -0.5},
                                                             {"5.", 5},
                                                             {"1E+2", 100},
                                                             {"9007199254740993", 9007199254740992.0},
                                                             {"4.9e-324", 5e-324},
                                                             {"1e-400", 0},
                                                             {"2.2250738585072011e-308", 2.2250738585072011e-308},
                                                             {"-1e-400", -0.0},
                                                             {"1e400", HUGE_VAL},
                                                             {"-1e400", -HUGE_VAL},
                                                             {"inf", HUGE_VAL},
                                                             {"-INF", -HUGE_VAL},
                                                             {"0.30000000000000004", 0.1 + 0.2},
                                                             {"Infinity", HUGE_VAL}};
  for (const auto& [word, value] : cases) {
    INFO(word);
    const double read = parse_off(replaced(tetrahedron, "0 0 0", word + " 0 0"), "x.off").vertices[0].x();
    CHECK(read == value);
    CHECK(std::signbit(read) == std::signbit(value));
  }
  CHECK(std::isnan(parse_off(replaced(tetrahedron, "0 0 0", "nan 0 0"), "x.off").vertices[0].x()));
  for (const char* word : {"++1", "+-1", "1..2", "1e", "e5", "0x10", "1,5", "one", "-", "+", "."}) {
    INFO(word);
    CHECK(fault_of([&] { parse_off(replaced(tetrahedron, "0 0 0", std::string(word) + " 0 0"), "x.off"); }) ==
          "file-syntax");
  }
}

TEST_CASE("convex polygons become fans from their first corner and keep their line", "[off]") {
  const RawMesh mesh =
      parse_off("OFF 5 2 0\n0 0 0 1 0 0 2 1 0 1 2 0 0 1 0\n5 3 4 0 1 2 # pentagon\n3 0 1 2\n", "x.off");
  CHECK(mesh.faces == std::vector<Face>{{3, 4, 0}, {3, 0, 1}, {3, 1, 2}, {0, 1, 2}});
  CHECK(mesh.face_lines == std::vector<std::uint32_t>{3, 3, 3, 4});
  REQUIRE(mesh.notes.size() == 1);
  CHECK(mesh.notes[0].starts_with("1 polygon "));
}

TEST_CASE("what is skipped is noted", "[off]") {
  const RawMesh more = parse_off(tetrahedron + "# only a comment\n\n0 1\n", "x.off");
  REQUIRE(more.notes.size() == 1);
  CHECK(more.notes[0].find("line 13") != std::string::npos);
  CHECK(parse_off(tetrahedron + "# only a comment\n\n", "x.off").notes.empty());
}

TEST_CASE("colours and normals under a plain OFF header are read past, whatever their number", "[off]") {
  const RawMesh expected = parse_off(tetrahedron, "x.off");
  for (const char* extras : {" 255 0 0 255", " 0.5 0.5 0.5", " 0 0 1 255 0 0 255", " 1", " 1 1 1 1", " 3 0 0 3"}) {
    std::string text = tetrahedron;
    for (const char* vertex : {"\n0 0 0\n", "\n1 0 0\n", "\n0 1 0\n", "\n0 0 1\n"})
      text = replaced(text, vertex, std::string(vertex).substr(0, 6) + extras + "\n");
    INFO(text);
    const RawMesh mesh = parse_off(text, "x.off");
    CHECK(mesh.vertices == expected.vertices);
    CHECK(mesh.faces == expected.faces);
    REQUIRE(mesh.notes.size() == 1);
    CHECK(mesh.notes[0].starts_with("The header says OFF, but vertex lines hold "));
    // Cut off, it is a file that was cut off; with one number missing, the header is named.
    CHECK(fault_of([&] { parse_off(text.substr(0, text.size() - 9), "x.off"); }) == "file-truncated");
  }
  const std::string uneven =
      replaced(replaced(tetrahedron, "0 0 0", "0 0 0 255 0 0 255"), "1 0 0", "1 0 0 255 0 0 255");
  CHECK(message_of(uneven).find("under the header OFF: one with colours must say COFF") != std::string::npos);
  // Several vertices on a line are what the format allows.
  CHECK(parse_off("OFF 4 4 6\n0 0 0 1 0 0\n0 1 0 0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n", "x").faces ==
        expected.faces);
  for (const char* header : {"COFF", "NOFF", "STOFF", "CNOFF"})
    CHECK(message_of(replaced(tetrahedron, "OFF", header)).find("the header " + std::string(header) + " asks for ") !=
          std::string::npos);
}

TEST_CASE("faces of one and two corners are left out and counted", "[off]") {
  const RawMesh mesh = parse_off(
      replaced(replaced(tetrahedron, "4 4 6", "4 7 6"), "3 0 1 3", "1 3\n2 0 1\n3 0 1 3\n2 1 0 255 0 0"), "x");
  CHECK(mesh.faces == parse_off(tetrahedron, "x").faces);
  CHECK(mesh.face_lines == std::vector<std::uint32_t>{7, 10, 12, 13});
  CHECK(mesh.notes == std::vector<std::string>{"Left out, as they bound no volume: 2 lines or faces of two corners, "
                                               "1 point or face of one corner."});
}

TEST_CASE("messages name file, line, face and what was found", "[off]") {
  CHECK(message_of(replaced(tetrahedron, "3 1 2 3", "3 1 2 7")).starts_with("x.off:9: face 2 names vertex 7"));
  CHECK(message_of(replaced(tetrahedron, "1 0 0", "1 zero 0")).find("x.off:4: ") == 0);
  CHECK(message_of(replaced(tetrahedron, "1 0 0", "1 zero 0")).find("'zero'") != std::string::npos);
  CHECK(message_of(tetrahedron.substr(0, 40)).find("4 of 4 vertices and 0 of 4 faces") != std::string::npos);
  CHECK(message_of(replaced(tetrahedron, "OFF", "\x1b[31m")).find('\x1b') == std::string::npos);
}

TEST_CASE("hashes are those of sha256sum and numpy", "[sha256]") {
  CHECK(sha256_hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  RawMesh mesh = parse_off(tetrahedron, "x.off");
  const std::string hash = "722eb1b8383084d0e14d4ad9db2001f820ec4032803b938fbe1321dc4cfb8ce9";
  CHECK(sha256_of_geometry(mesh) == hash);
  mesh.name = "another";
  mesh.notes = {"more"};
  CHECK(sha256_of_geometry(mesh) == hash);
  mesh.vertices[0].x() = -0.0;
  CHECK(sha256_of_geometry(mesh) != hash);
  CHECK(sha256_of_geometry(RawMesh{}) == sha256_hex(""));
}
