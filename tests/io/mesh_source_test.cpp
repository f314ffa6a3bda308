// What a word for a mesh means.
#include "host/io/mesh_source.hpp"

#include "host/io/file.hpp"
#include "host/io/sha256.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

constexpr const char* four_faces = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

// Works in a folder until the end of the scope.
class WorkingFolder {
public:
  explicit WorkingFolder(const TemporaryFolder& folder) : before_(fs::current_path()) {
    fs::current_path(folder.path());
  }
  ~WorkingFolder() { fs::current_path(before_); }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;

private:
  fs::path before_;
};

json answer(const std::vector<std::string>& arguments) {
  const ProgramRun run = run_program(arguments);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  return json::parse(run.out);
}

} // namespace

TEST_CASE("a word means the same mesh whatever files there are", "[mesh_source]") {
  const TemporaryFolder folder;
  const WorkingFolder here(folder);
  for (const char* name : {"builtin:box", "benchmark", "cgal:bull", "cow.off"}) std::ofstream(name) << four_faces;
  CHECK(mesh_kind("builtin:box") == MeshKind::builtin);
  CHECK(mesh_kind("benchmark") == MeshKind::catalogue);
  CHECK(mesh_kind("cgal:bull") == MeshKind::catalogue);
  CHECK(mesh_kind("cgal:no-such-body") == MeshKind::catalogue);
  CHECK(mesh_kind("-") == MeshKind::standard_input);
  for (const char* path : {"cow.off", "./benchmark", "Benchmark", "sub/benchmark", "./-", ""})
    CHECK(mesh_kind(path) == MeshKind::file);
  for (const char* word : {"builtin:box", "benchmark", "cgal:bull", "-"}) CHECK(mesh_word_anywhere(word) == word);
  CHECK(fs::equivalent(mesh_word_anywhere("./benchmark"), folder / "benchmark"));
  CHECK(fs::path(mesh_word_anywhere("cow.off")).is_absolute());
  const RawMesh box = load_mesh("builtin:box");
  CHECK(box.faces.size() == 12);
  REQUIRE(!box.notes.empty());
  CHECK_THAT(box.notes.back(), Contains("./builtin:box"));
  const RawMesh file = load_mesh("./builtin:box");
  CHECK(file.faces.size() == 4);
  CHECK(file.sha256 == sha256_hex(std::string_view(four_faces)));
}

TEST_CASE("a file in the way of a name is neither measured nor taken for the output's", "[mesh_source][cli]") {
  const TemporaryFolder folder;
  const WorkingFolder here(folder);
  std::ofstream("builtin:box") << four_faces;
  const json box = answer({"inspect", "builtin:box", "--json"});
  CHECK(box["faces"] == 12);
  const json file = answer({"inspect", "./builtin:box", "--json"});
  CHECK(file["faces"] == 4);
  CHECK(run_program({"inspect", "./builtin:box", "-o", "builtin:box"}).exit_code == 2);
}

TEST_CASE("reproduce measures the mesh whose hash it records, and its stages the same one", "[mesh_source][cli]") {
  const TemporaryFolder folder;
  const WorkingFolder here(folder);
  std::ofstream("builtin:box:1,2,3") << four_faces;
  std::ofstream("body") << four_faces;
  const auto reproduced = [&](const char* mesh, const char* out) {
    const ProgramRun run =
        run_program({"reproduce", "-o", out, "--mesh", mesh, "--only", "inspect,tensors", "--device", "cpu"});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    const auto read = [&](const std::string& name) { return json::parse(read_file(folder / (out + ("/" + name)))); };
    const json all = read("reproduce.json"), inspected = read("data/inspect.json");
    CHECK(read("data/tensors.json")["input"]["sha256"] == all["mesh"]["sha256"]);
    CHECK(inspected["sha256"] == all["mesh"]["sha256"]);
    return inspected["faces"].get<int>();
  };
  CHECK(reproduced("builtin:box:1,2,3", "a") == 12);
  CHECK(reproduced("./builtin:box:1,2,3", "b") == 4);
  CHECK(reproduced("body", "c") == 4);
}

TEST_CASE("reproduce measures the catalogue's cow beside a file called benchmark", "[mesh_source][cli][benchmark]") {
  if (!benchmark_cow()) return skip_without_cow();
  const TemporaryFolder folder;
  ProgramOptions options;
  if (const char* meshes = std::getenv("COWGPU_MESHES")) options.environment["COWGPU_MESHES"] = fs::absolute(meshes);
  const WorkingFolder here(folder);
  std::ofstream("benchmark") << four_faces;
  const ProgramRun run =
      run_program({"reproduce", "-o", "out", "--only", "inspect,tensors", "--device", "cpu"}, options);
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const json all = json::parse(read_file(folder / "out/reproduce.json"));
  CHECK(all["mesh"]["sha256"] == benchmark_sha256);
  CHECK(json::parse(read_file(folder / "out/data/inspect.json"))["sha256"] == benchmark_sha256);
  CHECK(json::parse(read_file(folder / "out/data/tensors.json"))["input"]["sha256"] == benchmark_sha256);
}

TEST_CASE("reproduce: folders and meshes that cannot be used are named, with an exit code of their kind",
          "[mesh_source][cli]") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::vector<std::string>& more, int code, const char* word) {
    std::vector<std::string> arguments = {"reproduce", "--device", "cpu", "--only", "inspect"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramRun run = run_program(arguments);
    INFO(run.err);
    CHECK(run.exit_code == code);
    CHECK_THAT(run.err, Contains(word));
  };
  refused({"-o", folder / "o", "--mesh", "-"}, 2, "standard input is read once");
  // A folder where a stage's output belongs.
  fs::create_directories(folder / "a/data/inspect.json/in-the-way");
  refused({"-o", folder / "a", "--mesh", "builtin:box"}, 5, "inspect.json");
  // A file where the folder of results belongs.
  std::ofstream(folder / "b") << "text";
  refused({"-o", folder / "b", "--mesh", "builtin:box"}, 5, "take another one with -o");
  refused({"-o", folder / std::string(300, 'x'), "--mesh", "builtin:box"}, 5, "cannot be made");
  refused({"-o", folder / "c", "--mesh", std::string(300, 'y')}, 5, "yyy");
  refused({"-o", folder / "d", "--mesh", folder.path()}, 5, folder.path().c_str());
}

TEST_CASE("where a mesh is wanted, our own documents are called by what they are", "[mesh-source]") {
  const TemporaryFolder folder;
  const std::string result = folder / "m.json", table = folder / "m.gfc", tensors = folder / "t.json";
  REQUIRE(run_program({"expand", "builtin:box", "--lmax", "2", "-o", result, "-q"}).exit_code == 0);
  REQUIRE(run_program({"convert", result, table, "-q"}).exit_code == 0);
  std::ofstream(tensors) << run_program({"tensors", "builtin:box", "--json"}).out;
  const auto says = [](const std::string& file) {
    const ProgramRun run = run_program({"expand", file});
    CHECK(run.exit_code == 3);
    return run.err;
  };
  CHECK_THAT(says(result), Contains("holds coefficients (cowgpu.result.v1), and no mesh") && Contains("`reconstruct`"));
  CHECK_THAT(says(table), Contains("holds coefficients, and no mesh") && Contains("`potential`"));
  CHECK_THAT(says(tensors), Contains("a document of cowgpu (cowgpu.tensors.v1), and no mesh"));
}
