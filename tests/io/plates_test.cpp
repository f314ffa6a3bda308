#include "host/io/plates.hpp"

#include "host/io/file.hpp"
#include "host/io/mesh_format.hpp"
#include "host/io/sha256.hpp"
#include "host/mesh/audit.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reader_checks.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

const std::string tables = "4 4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n1 1 3 2\n2 1 2 4\n3 2 3 4\n4 1 4 3\n";

Outcome outcome(const std::string& text) {
  return outcome_of([&] { parse_plates(text, "x.tab"); });
}

std::string plates_text(const RawMesh& mesh) {
  std::string text = fmt::format("{} {}\n", mesh.vertices.size(), mesh.faces.size());
  for (const Vec3& p : mesh.vertices) text += fmt::format("{:.6f} {:.6f} {:.6f}\n", p.x(), p.y(), p.z());
  for (const Face& f : mesh.faces) text += fmt::format("{} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  return text;
}

} // namespace

TEST_CASE("a plate model is read as it stands in the file, with and without numbers of rows", "[plates][readers]") {
  const std::vector<Face> faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n", plates = "1 3 2\n1 2 4\n2 3 4\n1 4 3\n";
  const std::string numbered = tables.substr(4, 32);
  for (const std::string& text :
       {tables, "4 4\n" + points + plates, "4\n" + numbered + "4\n" + plates, "4 4\n" + numbered + plates,
        "4 4\n" + points + "0 1 3 2\n1 1 2 4\n2 2 3 4\n3 1 4 3\n",
        "4 4\n" + points + "3 1 3 2\n3 1 2 4\n3 2 3 4\n3 1 4 3\n",
        "\xef\xbb\xbf\r\n# km\r\n 4 4\r\n\r\n" + points + plates}) {
    INFO(text);
    const RawMesh mesh = parse_plates(text, "folder/x.tab");
    CHECK(mesh.name == "folder/x.tab");
    CHECK(mesh.sha256 == sha256_hex(text));
    CHECK(mesh.vertices == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    CHECK(mesh.faces == faces);
    CHECK(mesh.face_lines.size() == 4);
    CHECK(mesh.notes.empty());
  }
  CHECK(parse_plates(tables, "x").face_lines == std::vector<std::uint32_t>{6, 7, 8, 9});
  const RawMesh from_zero = parse_plates("4 4\n" + points + "0 2 1\n0 1 3\n1 2 3\n0 3 2\n7 7\n", "x");
  CHECK(from_zero.faces == faces);
  REQUIRE(from_zero.notes.size() == 2);
  CHECK(from_zero.notes[0].find("numbered from 0") != std::string::npos);
  CHECK(from_zero.notes[1] == "Data after the last announced plate were ignored (from line 10).");
}

TEST_CASE("messages about plate models name file, line and what was found", "[plates][readers]") {
  CHECK(outcome(replaced(tables, "3 2 3 4", "3 2 3 5"))
            .message.starts_with("x.tab:8: row 3 of the plates names vertex 5"));
  CHECK(outcome(replaced(tables, "3 2 3 4", "3 2 3 -1")).fault == "mesh-index-range");
  CHECK(outcome(replaced(tables, "3 2 3 4", "3 2 3 0")).says("both 0 and that number"));
  CHECK(outcome(replaced(tables, "3 2 3 4", "4 2 3 4")).says("3 expected where row 3 of the plates begins, found '4'"));
  CHECK(outcome(replaced(tables, "3 2 3 4", "2 3 4")).says("has 3 values, the first one 4"));
  CHECK(outcome(replaced(tables, "3 0 1 0", "3 0 one 0")).message.starts_with("x.tab:4: "));
  CHECK(outcome(replaced(tables, "4 4\n", "4 5\n")).fault == "file-truncated");
  CHECK(outcome(replaced(tables, "4 4\n", "4 5\n")).says("4 of 4 vertices and 4 of 5 plates"));
  CHECK(outcome(replaced(tables, "4 4\n", "4 4 6\n")).fault == "file-format");
  CHECK(outcome(replaced(tables, "4 4\n", "-4 4\n")).fault == "file-syntax");
  CHECK(outcome(replaced(tables, "\n1 1 3 2", "\n7 1 3 2")).says("numbered from 7"));
}

TEST_CASE("plate models cut off are truncated, and false counts cost no memory", "[plates][readers]") {
  const std::size_t last_row = tables.rfind("4 1 4 3");
  for (std::size_t size = 4; size < last_row + 7; ++size)
    if (tables[size - 1] == '\n' || tables[size] == '\n' || size > last_row) {
      INFO(size);
      const std::string fault = outcome(tables.substr(0, size)).fault;
      CHECK((fault == "file-truncated" || size == last_row + 7));
    }
  const std::size_t growth = peak_growth([&] {
    for (const char* counts : {"4294967295 4\n", "4 4294967295\n", "4294967295 4294967295\n", "4294967296 4\n"})
      CHECK(outcome(replaced(tables, "4 4\n", counts)).fault != "none");
  });
  if (memory_is_measurable()) CHECK(growth < std::size_t{4} << 20);
  const std::string large = plates_text(icosphere(6));
  const std::size_t needed = peak_growth([&] { parse_plates(large, "x"); });
  if (memory_is_measurable()) CHECK(needed < 4 * large.size());
  check_prefixes(tables, [](std::string_view bytes) { parse_plates(bytes, "x"); });
  check_mutations(tables, 5000, [](std::string_view bytes) { parse_plates(bytes, "x"); });
}

TEST_CASE("public plate models have the volumes that are known", "[plates][readers]") {
  const char* folder = std::getenv("COWGPU_FIELD");
  if (folder == nullptr) {
    std::cout << "SKIPPED: COWGPU_FIELD does not name the folder of public plate models\n";
    return;
  }
  const struct {
    const char* file;
    std::size_t vertices, faces;
    double volume;
  } bodies[] = {{"eros007790.tab", 3897, 7790, 2525.99460318316},
                {"EROS856Vert1708Fac.txt", 856, 1708, 2491.6158371488315},
                {"itokawa_32.obj", 6146, 12288, 0.017701999}};
  for (const auto& body : bodies) {
    INFO(body.file);
    const RawMesh mesh = parse_mesh(read_file(std::filesystem::path(folder) / body.file), body.file);
    const Audit facts = audit(mesh);
    CHECK(facts.vertices == body.vertices);
    CHECK(facts.faces == body.faces);
    CHECK((facts.closed && facts.consistently_oriented));
    CHECK(facts.volume.value() == Approx(body.volume).epsilon(1e-8));
  }
}
