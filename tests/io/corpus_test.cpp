// Mesh files of every format under tests/corpus. accepted/: closed surfaces, each with the word `volume` and its volume
// near its beginning. refused/: <fault>--<what>.<suffix>, each good but for one thing.
#include "host/io/file.hpp"
#include "host/io/mesh_format.hpp"
#include "host/mesh/audit.hpp"
#include "host/mesh/closed_surface.hpp"
#include "tests/support/reader_checks.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <map>

using namespace cowgpu;
using namespace cowgpu::test;

namespace {

void take(RawMesh mesh) {
  ManifoldSurface::from(ClosedSurface::from(std::move(mesh)));
}

} // namespace

TEST_CASE("every refused file of the corpus fails as its name says", "[corpus][readers]") {
  const auto files = corpus("refused");
  REQUIRE(files.size() >= 150);
  for (const auto& file : files) {
    const std::string stem = file.stem().string(), expected = stem.substr(0, stem.find("--"));
    INFO(file.filename());
    const std::string bytes = read_file(file);
    const Outcome outcome = outcome_of([&] { take(parse_mesh(bytes, file.filename())); });
    CHECK(outcome.fault == expected);
    CHECK(outcome.message.find_first_not_of(" ~") != std::string::npos);
    // What maps refuse is good enough for volumes.
    if (expected.ends_with("-manifold"))
      CHECK(outcome_of([&] { ClosedSurface::from(parse_mesh(bytes, file.filename())); }).fault == "none");
  }
}

TEST_CASE("every accepted file of the corpus has the volume it says", "[corpus][readers]") {
  const auto files = corpus("accepted");
  REQUIRE(files.size() >= 85);
  std::map<std::string, int> suffixes;
  for (const auto& file : files) {
    INFO(file.filename());
    ++suffixes[file.extension()];
    const std::string bytes = read_file(file), mark = "volume ";
    const std::size_t at = bytes.find(mark);
    REQUIRE(at < 200);
    const double expected = std::stod(bytes.substr(at + mark.size(), 30));
    const ClosedSurface surface = ClosedSurface::from(parse_mesh(bytes, file.filename()));
    CHECK(std::fabs(volume(surface) - expected) <= 4 * 0x1p-53 * expected);
    const Audit facts = audit(surface.mesh());
    CHECK((facts.closed && facts.consistently_oriented && facts.finite && facts.outward));
    CHECK(facts.volume == volume(surface));
    CHECK((surface.mesh().face_lines.empty() || surface.mesh().face_lines.size() == surface.faces().size()));
  }
  for (const char* suffix : {".off", ".obj", ".ply", ".stl", ".gltf", ".glb", ".tab", ""}) CHECK(suffixes[suffix] > 0);
}

TEST_CASE("every prefix of an accepted file is read or refused by name", "[corpus][readers]") {
  for (const auto& file : corpus("accepted")) {
    INFO(file.filename());
    check_prefixes(read_file(file), [&](std::string_view bytes) { parse_mesh(bytes, file.filename()); });
  }
}

TEST_CASE("files with random bytes changed are read or refused by name", "[corpus][readers]") {
  const auto walk = [] {
    for (const auto& file : corpus("accepted")) {
      INFO(file.filename());
      check_mutations(read_file(file), 300, [&](std::string_view bytes) {
        RawMesh mesh = parse_mesh(bytes, file.filename());
        audit(mesh);
        take(std::move(mesh));
      });
    }
  };
  walk();
}

TEST_CASE("no file of the corpus, whole or damaged, takes more than 64 MiB", "[corpus][readers]") {
  if (!memory_is_measurable()) return;
  const std::size_t growth = peak_growth([] {
    for (const char* folder : {"accepted", "refused"})
      for (const auto& file : corpus(folder)) {
        const std::string bytes = read_file(file);
        const auto read = [&](std::string_view part) { outcome_of([&] { take(parse_mesh(part, file.filename())); }); };
        read(bytes);
        check_mutations(bytes, 100, read);
      }
  });
  INFO(growth);
  CHECK(growth < std::size_t{64} << 20);
}

TEST_CASE("the program refuses files of every format with exit code 3 and the fault's name", "[corpus][readers][cli]") {
  for (const char* file : {"file-syntax--word-among-vertices.off", "file-syntax--five-numbers.obj",
                           "file-truncated--four-billion-vertices.ply", "file-truncated--four-billion-facets.stl",
                           "file-format--draco.gltf", "file-truncated--half.glb", "file-format--prose"}) {
    const ProgramRun run = run_program({"inspect", std::string(COWGPU_CORPUS) + "/refused/" + file});
    const std::string fault = std::string(file).substr(0, std::string(file).find("--"));
    INFO(run.err);
    CHECK(run.exit_code == 3);
    CHECK(run.err.find("[" + fault + "]") != std::string::npos);
    CHECK(run.out.empty());
  }
}
