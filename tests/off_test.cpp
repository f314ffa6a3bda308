#include "host/io/off.hpp"

#include "host/error.hpp"
#include "host/io/file.hpp"
#include "host/io/sha256.hpp"
#include "host/mesh/audit.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <functional>
#include <random>
#include <sys/resource.h>

using namespace cowgpu;
namespace fs = std::filesystem;

namespace {

/// The name of the fault that `work` ends with, or "none".
std::string fault_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return std::string(name(error.fault()));
  }
  return "none";
}

std::string message_of(const std::string& text) {
  try {
    parse_off(text, "x.off");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::vector<fs::path> corpus(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(COWGPU_CORPUS) / folder))
    if (entry.path().extension() == ".off") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

const std::string tetrahedron = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

} // namespace

TEST_CASE("every refused file of the corpus fails as its name says", "[off]") {
  const auto files = corpus("refused");
  REQUIRE(files.size() >= 20);
  for (const fs::path& file : files) {
    const std::string stem = file.stem().string(), expected = stem.substr(0, stem.find("--"));
    INFO(file.filename());
    CHECK(fault_of([&] {
            ClosedSurface closed = ClosedSurface::from(parse_off(read_file(file), "x.off"));
            ManifoldSurface::from(std::move(closed));
          }) == expected);
    // What maps refuse is good enough for volumes.
    if (expected.ends_with("-manifold"))
      CHECK(fault_of([&] { ClosedSurface::from(parse_off(read_file(file), "x.off")); }) == "none");
  }
}

TEST_CASE("every accepted file of the corpus has the volume its first comment says", "[off]") {
  const auto files = corpus("accepted");
  REQUIRE(files.size() >= 15);
  for (const fs::path& file : files) {
    INFO(file.filename());
    const std::string text = read_file(file), mark = "# volume ";
    const std::size_t at = text.find(mark);
    REQUIRE(at <= 3);
    const double expected = std::stod(text.substr(at + mark.size()));
    const ClosedSurface surface = ClosedSurface::from(parse_off(text, file.filename()));
    CHECK(std::fabs(volume(surface) - expected) <= 4 * 0x1p-53 * expected);
    const Audit facts = audit(surface.mesh());
    CHECK((facts.closed && facts.consistently_oriented && facts.finite && facts.outward));
    CHECK(facts.volume == volume(surface));
  }
}

TEST_CASE("every prefix of an accepted file parses or is refused by name", "[off]") {
  for (const fs::path& file : corpus("accepted")) {
    INFO(file.filename());
    const std::string text = read_file(file);
    for (std::size_t size = 0; size < text.size(); ++size) {
      // A copy of just that size lets the address sanitizer see reads beyond its end.
      const std::vector<char> prefix(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(size));
      CHECK_NOTHROW(fault_of([&] { parse_off({prefix.data(), prefix.size()}, "x.off"); }));
    }
  }
}

TEST_CASE("prefixes that lack a face are truncated", "[off]") {
  const std::size_t last_face = tetrahedron.rfind("3 0 3 2");
  for (std::size_t size = 4; size < last_face + 6; ++size) {
    INFO(size);
    CHECK(fault_of([&] { parse_off(tetrahedron.substr(0, size), "x.off"); }) == "file-truncated");
  }
}

TEST_CASE("files with random bytes changed parse or are refused by name", "[off]") {
  std::mt19937 random(1);
  const std::string bytes = "0123456789 -+.eE#\n\r\tOFCNanif\xff";
  for (const fs::path& file : corpus("accepted")) {
    INFO(file.filename());
    const std::string text = read_file(file);
    for (int round = 0; round < 200; ++round) {
      std::string bad = text;
      for (std::size_t i = random() % 4 + 1; i != 0; --i) bad[random() % bad.size()] = bytes[random() % bytes.size()];
      INFO(bad);
      CHECK_NOTHROW(fault_of([&] {
        RawMesh mesh = parse_off(bad, "x.off");
        audit(mesh);
        ManifoldSurface::from(ClosedSurface::from(std::move(mesh)));
      }));
    }
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

TEST_CASE("polygons become fans from their first corner and keep their line", "[off]") {
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
