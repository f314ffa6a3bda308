#include "host/io/mesh_catalogue.hpp"
#include "host/io/mesh_source.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <set>

using namespace cowgpu::test;
using Catch::Contains;
namespace fs = std::filesystem;

TEST_CASE("the catalogue names each body once, with a hash of its own", "[meshes]") {
  std::set<std::string> names, hashes, files;
  for (const auto& entry : cowgpu::mesh_catalogue()) {
    INFO(entry.name);
    CHECK(names.insert(entry.name).second);
    CHECK(hashes.insert(entry.sha256).second);
    CHECK(files.insert(entry.file).second);
    CHECK(entry.sha256.size() == 64);
    CHECK_FALSE(entry.source.empty());
    CHECK_FALSE(entry.licence.empty());
  }
  CHECK(names.count("benchmark") == 1);
  CHECK(names.count("cgal:cow") == 1);
  CHECK(names.size() == 11);
  CHECK(cowgpu::catalogue_entry("benchmark")->sha256 == cowgpu::benchmark_sha256);
}

TEST_CASE("what the catalogue says of the bodies that are here is so", "[meshes]") {
  std::size_t here = 0;
  for (const auto& entry : cowgpu::mesh_catalogue()) {
    if (!cowgpu::find_catalogued(entry)) continue;
    ++here;
    INFO(entry.name);
    const cowgpu::RawMesh mesh = cowgpu::load_mesh(entry.name);
    CHECK(mesh.name == entry.name);
    CHECK(mesh.sha256 == entry.sha256);
    CHECK(mesh.vertices.size() == entry.vertices);
    CHECK(mesh.faces.size() == entry.triangles);
  }
  if (here == 0) WARN("SKIPPED: none of the catalogue's meshes is here");
}

TEST_CASE("meshes add checks a file's hash and copies it to where its name finds it", "[meshes][cli]") {
  const auto* entry = cowgpu::catalogue_entry("cgal:triceratops");
  const auto found = cowgpu::find_catalogued(*entry);
  if (!found) {
    WARN("SKIPPED: triceratops of Debian's libcgal-demo is not here; ./check fetches it");
    return;
  }
  const TemporaryFolder folder;
  const std::string renamed = folder / "some.off", own = folder / "own";
  fs::copy_file(*found, renamed);
  ProgramOptions options;
  options.environment["COWGPU_MESHES"] = own;
  const ProgramRun added = run_program({"meshes", "add", renamed}, options);
  const ProgramRun listed = run_program({"meshes"}, options);
  std::ofstream(renamed, std::ios::app) << "# changed\n";
  const ProgramRun changed = run_program({"meshes", "add", renamed}, options);
  // A file of another hash in its place is not taken for it, and not written over.
  const std::string place = own + "/cgal/triceratops.off";
  fs::copy_file(renamed, place, fs::copy_options::overwrite_existing);
  const ProgramRun in_the_way = run_program({"meshes", "add", *found}, options);

  INFO(added.err);
  CHECK(added.exit_code == 0);
  CHECK_THAT(added.out, Contains("cgal:triceratops"));
  CHECK(fs::exists(place));
  CHECK_THAT(listed.out, Contains(place));
  CHECK(changed.exit_code == 3);
  CHECK_THAT(changed.err, Contains("file-format") && Contains("no file of its SHA-256"));
  CHECK(in_the_way.exit_code == 5);
  CHECK_THAT(in_the_way.err, Contains("is another mesh") && Contains("left as it is"));
  CHECK(fs::file_size(place) == fs::file_size(renamed));
}

TEST_CASE("a name that the catalogue lacks is no path", "[meshes][cli]") {
  const ProgramRun run = run_program({"inspect", "cgal:unicorn"});
  CHECK(run.exit_code == 3);
  CHECK_THAT(run.err, Contains("mesh-missing") && Contains("cowgpu meshes"));
}
