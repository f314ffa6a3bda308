#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

using namespace cowgpu::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

std::size_t files_in(const std::string& folder) {
  const auto all = std::filesystem::directory_iterator(folder);
  return std::size_t(std::distance(begin(all), end(all)));
}

const std::string cube = "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
                         "4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

} // namespace

TEST_CASE("expand without a mesh takes the built-in cow and names it, its hash and its triangles first", "[cli]") {
  const ProgramRun run = run_program({"expand", "--lmax", "4", "--device", "cpu"});
  INFO(run.err);
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, StartsWith("mesh builtin:cow@"));
  const std::string first = run.out.substr(0, run.out.find('\n'));
  CHECK_THAT(first, Contains("sha256 ") && Contains(" triangles"));
  CHECK_THAT(run.out, Contains("not conjugated") && Contains("quadrupole") && Contains("inertia"));
  CHECK_THAT(run.out, Contains("passed"));
}

TEST_CASE("a software device is named as such", "[cli][vulkan]") {
  const ProgramRun run = run_program({"expand", "builtin:box", "--lmax", "2"});
  CHECK(run.exit_code == 0);
  if (run.out.find("CPU path on") != std::string::npos) {
    WARN("SKIPPED: no Vulkan device");
    return;
  }
  CHECK_THAT(run.out, Contains("Vulkan 1."));
  if (run.out.find("llvmpipe") != std::string::npos) CHECK_THAT(run.out, Contains("software device"));
}

TEST_CASE("absurd arguments are usage errors that say what is allowed", "[cli]") {
  const std::vector<std::vector<std::string>> wrong = {
      {"expand", "--lmax", "-1"},
      {"expand", "--lmax", "1e9"},
      {"expand", "--lmax", "4097"},
      {"expand", "--lmax", "99999999999999999999"},
      {"expand", "--lmax", "abc"},
      {"expand", "--lmax"},
      {"expand", "--no-such-option"},
      {"expand", "--of", "sound"},
      {"expand", "--origin", "1,2"},
      {"expand", "--origin", "1,2,nan"},
      {"expand", "--origin", "1e30,0,0"},
      {"expand", "--density", "nan"},
      {"expand", "--density", "0"},
      {"expand", "--density", "heavy"},
      {"expand", "--cut-off", "2"},
      {"expand", "--cut-off", "-1"},
      {"expand", "--verify", "maybe"},
      {"expand", "--progress", "loud"},
      {"expand", "-o", "coefficients.txt"},
      {"expand", "builtin:horse"},
      {"expand", "builtin:cow@99"},
      {"expand", "builtin:sphere:-1"},
      {"expand", "a.off", "b.off"},
      {"bench", "--runs", "0"},
      {"milk"},
      {},
  };
  for (const auto& arguments : wrong) {
    std::string line;
    for (const auto& word : arguments) line += word + " ";
    INFO(line);
    const ProgramRun run = run_program(arguments);
    INFO(run.err);
    CHECK(run.exit_code == 2);
    CHECK_THAT(run.err, StartsWith("cowgpu: error [bad-argument]: "));
    CHECK(run.out.empty());
  }
}

TEST_CASE("help and version go to standard output and succeed", "[cli]") {
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"--help"}, {"--version"}, {"expand", "--help"}, {"validate", "--help"}, {"bench", "--help"}}) {
    const ProgramRun run = run_program(arguments);
    CHECK(run.exit_code == 0);
    CHECK(!run.out.empty());
    CHECK(run.err.empty());
  }
}

TEST_CASE("a missing file, a folder and an unreadable mesh are named errors", "[cli]") {
  const TemporaryFolder folder;
  CHECK(run_program({"expand", folder / "none.off"}).exit_code == 5);
  CHECK(run_program({"expand", folder.path()}).exit_code == 5);
  write_text(folder / "noise.off", "this is no mesh");
  const ProgramRun noise = run_program({"expand", folder / "noise.off"});
  CHECK(noise.exit_code == 3);
  CHECK_THAT(noise.err, StartsWith("cowgpu: error [file-format]: "));
}

TEST_CASE("the benchmark, where it is missing, says where to get it", "[cli]") {
  const TemporaryFolder folder;
  if (std::filesystem::exists(std::filesystem::path(COWGPU_SOURCE) / "data" / "meshes" / "cow.off")) {
    WARN("SKIPPED: cow.off lies in data/meshes");
    return;
  }
  ProgramOptions options;
  options.environment["COWGPU_MESHES"] = folder.path();
  const ProgramRun run = run_program({"expand", "benchmark"}, options);
  CHECK(run.exit_code == 3);
  CHECK_THAT(run.err, Contains("[mesh-missing]") && Contains("libigl") && Contains("COWGPU_MESHES"));
  write_text(folder / "cow.off", cube);
  const ProgramRun other = run_program({"expand", "benchmark"}, options);
  CHECK(other.exit_code == 3);
  CHECK_THAT(other.err, Contains("is another mesh"));
}

TEST_CASE("an output that cannot be written fails before the work and leaves nothing", "[cli]") {
  const TemporaryFolder folder;
  CHECK(run_program({"expand", "--lmax", "2", "-o", folder / "none/x.json"}).exit_code == 5);
  CHECK(run_program({"expand", "--lmax", "2", "-o", "/proc/x.json"}).exit_code == 5);
  CHECK(files_in(folder.path()) == 0);
  ProgramOptions full;
  full.stdout_to = "/dev/full";
  const ProgramRun run = run_program({"expand", "builtin:box", "--lmax", "2", "--device", "cpu"}, full);
  CHECK(run.exit_code == 5);
  CHECK_THAT(run.err, Contains("[cannot-write]"));
}

TEST_CASE("without a driver auto computes on the CPU and says why, and a named device is an error", "[cli]") {
  ProgramOptions options;
  options.environment["VK_DRIVER_FILES"] = "/nonexistent.json";
  options.environment["VK_ICD_FILENAMES"] = "/nonexistent.json";
  const ProgramRun fallback = run_program({"expand", "builtin:box", "--lmax", "2"}, options);
  CHECK(fallback.exit_code == 0);
  CHECK_THAT(fallback.out, Contains("CPU path on") && Contains("note: the CPU path is used"));
  CHECK_THAT(fallback.err, Contains("the CPU path is used, because"));
  const ProgramRun named = run_program({"expand", "builtin:box", "--lmax", "2", "--device", "0"}, options);
  CHECK(named.exit_code == 4);
  CHECK_THAT(named.err, Contains("[no-device]") && Contains("--device cpu"));
  const ProgramRun list = run_program({"devices"}, options);
  CHECK(list.exit_code == 0);
  CHECK_THAT(list.out, Contains("no Vulkan device") && Contains("cpu:"));
}

TEST_CASE("without a Vulkan loader the program runs and explains itself", "[cli]") {
  const TemporaryFolder folder;
  // A file of that name that is no library hides the real one.
  write_text(folder / "libvulkan.so.1", "");
  write_text(folder / "libvulkan.so", "");
  ProgramOptions options;
  options.environment["LD_LIBRARY_PATH"] = folder.path();
  const ProgramRun fallback = run_program({"expand", "builtin:box", "--lmax", "2"}, options);
  CHECK(fallback.exit_code == 0);
  CHECK_THAT(fallback.err, Contains("no Vulkan loader"));
  const ProgramRun named = run_program({"expand", "builtin:box", "--device", "llvmpipe"}, options);
  CHECK(named.exit_code == 4);
  CHECK_THAT(named.err, Contains("[no-loader]"));
}

TEST_CASE("an unknown device is an error that lists the devices", "[cli]") {
  const ProgramRun run = run_program({"expand", "builtin:box", "--device", "abacus"});
  CHECK(run.exit_code == 4);
  CHECK(run_program({"expand", "builtin:box", "--device", "77"}).exit_code == 4);
}

TEST_CASE("an interrupt ends long work with 130 and leaves the old file", "[cli]") {
  const TemporaryFolder folder;
  for (const char* device : {"cpu", "auto"}) {
    INFO(device);
    write_text(folder / "out.json", "old");
    ProgramOptions options;
    options.interrupt_after = 2;
    const ProgramRun run = run_program(
        {"expand", "builtin:sphere@7", "--lmax", "2000", "--device", device, "-o", folder / "out.json"}, options);
    INFO(run.err);
    CHECK(run.exit_code == 130);
    CHECK_THAT(run.err, Contains("[interrupted]"));
    CHECK(read_text(folder / "out.json") == "old");
    CHECK(files_in(folder.path()) == 1);
  }
}

TEST_CASE("an interrupt ends the wait for a pipe", "[cli]") {
  const TemporaryFolder folder;
  REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
  ProgramOptions options;
  options.interrupt_after = 0.5;
  const ProgramRun run = run_program({"inspect", folder / "pipe"}, options);
  CHECK(run.exit_code == 130);
  CHECK_THAT(run.err, Contains("[interrupted]"));
}

TEST_CASE("outputs may stand before the mesh and be named twice", "[cli]") {
  const TemporaryFolder folder;
  const ProgramRun run = run_program(
      {"expand", "-o", folder / "a.json", "-o", folder / "b.csv", "builtin:box", "--lmax", "2", "--device", "cpu"});
  INFO(run.err);
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, StartsWith("mesh builtin:box"));
  CHECK(files_in(folder.path()) == 2);
}

TEST_CASE("faces over the same three vertices do no harm", "[cli]") {
  const TemporaryFolder folder;
  // A cube of edge 1 with a doubled fin outside, which encloses nothing.
  std::string fin = cube;
  fin.replace(fin.find("8 6 0"), 5, "11 8 0");
  fin.insert(fin.find("4 0 3 2 1"), "2 0 0\n2.5 1 .3\n2.2 .2 1.1\n");
  write_text(folder / "fin.off", fin + "3 8 9 10\n3 8 10 9\n");
  for (const char* device : {"cpu", "auto"}) {
    const ProgramRun run = run_program({"expand", folder / "fin.off", "--lmax", "6", "--device", device});
    INFO(run.out << run.err);
    CHECK(run.exit_code == 0);
    CHECK_THAT(run.out, Contains("volume                     1\n"));
    CHECK(run_program({"validate", folder / "fin.off", "--lmax", "6", "--device", device}).exit_code == 0);
  }
}

TEST_CASE("a negative density negates and still agrees", "[cli]") {
  const ProgramRun run = run_program({"expand", "builtin:box", "--density", "-1", "--lmax", "6", "--device", "cpu"});
  INFO(run.out << run.err);
  CHECK(run.exit_code == 0);
}

TEST_CASE("a sample that lies in the origin is measured by the body's radius", "[cli]") {
  const TemporaryFolder folder;
  std::string many = cube;
  many.replace(many.find("8 6 0"), 5, "9 3006 0");
  many.insert(many.find("4 0 3 2 1"), "0 0 0\n");
  for (int i = 0; i < 3000; ++i) many += "3 8 8 8\n";
  write_text(folder / "many.off", many);
  const ProgramRun run =
      run_program({"expand", folder / "many.off", "--origin", "mesh", "--lmax", "4", "--device", "cpu"});
  INFO(run.out << run.err);
  CHECK(run.exit_code == 0);
}

TEST_CASE("a closed or full standard error stops nothing and spoils no file", "[cli]") {
  const TemporaryFolder folder;
  ProgramOptions options;
  options.close_stderr = true;
  CHECK(run_program({"expand", "no such file.off"}, options).exit_code == 5);
  const ProgramRun run = run_program(
      {"expand", "builtin:box", "--lmax", "2", "--device", "cpu", "-o", folder / "a.json", "-o", folder / "b.csv"},
      options);
  CHECK(run.exit_code == 0);
  CHECK_THAT(read_text(folder / "a.json"), StartsWith("{"));
  CHECK_THAT(read_text(folder / "b.csv"), StartsWith("# cowgpu"));
}

TEST_CASE("a device without an end is refused as too large", "[cli]") {
  const ProgramRun run = run_program({"inspect", "/dev/zero"});
  CHECK(run.exit_code == 3);
  CHECK_THAT(run.err, Contains("[too-large]"));
}

TEST_CASE("progress as JSON lines goes to standard error", "[cli]") {
  ProgramOptions options;
  options.interrupt_on = "fraction";
  const ProgramRun run =
      run_program({"expand", "builtin:sphere@7", "--lmax", "2000", "--device", "cpu", "--progress", "jsonl"}, options);
  CHECK_THAT(run.err, Contains("\"fraction\":") && Contains("\"seconds_left\":"));
  CHECK(run.exit_code == 130);
  CHECK(run.out.empty());
}

TEST_CASE("an origin far from the body is no false alarm", "[cli]") {
  for (const char* device : {"cpu", "auto"}) {
    const ProgramRun run =
        run_program({"expand", "builtin:box", "--origin", "1e3,0,0", "--lmax", "64", "--device", device});
    INFO(run.out << run.err);
    CHECK(run.exit_code == 0);
  }
}

TEST_CASE("a dry run prints plan and memory and computes nothing", "[cli]") {
  const TemporaryFolder folder;
  const ProgramRun run =
      run_program({"expand", "builtin:cow@2", "--lmax", "4096", "--dry-run", "-o", folder / "x.json"});
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("plan: mass multipoles to degree 4096") && Contains("memory: at most"));
  CHECK(files_in(folder.path()) == 0);
}

TEST_CASE("every fifth prefix of a mesh file gives a result or a named error", "[cli]") {
  const TemporaryFolder folder;
  for (std::size_t length = 0; length <= cube.size(); length += 5) {
    write_text(folder / "part.off", cube.substr(0, length));
    const ProgramRun run = run_program({"expand", folder / "part.off", "--lmax", "2", "--device", "cpu"});
    INFO(length << ": " << run.err);
    const bool named_error = run.exit_code == 3 && run.err.rfind("cowgpu: error [", 0) == 0;
    CHECK((run.exit_code == 0 || named_error));
  }
}

TEST_CASE("validate passes on a built-in body and prints a table", "[cli]") {
  const ProgramRun run = run_program({"validate", "builtin:cow@0", "--lmax", "20"});
  INFO(run.out << run.err);
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("CPU path against the reference") && Contains("passed"));
  CHECK_THAT(run.out, !Contains("FAILED"));
}

TEST_CASE("a check out of bounds is exit code 1 and the result is still printed", "[cli]") {
  // A cut-off this coarse misses the reference by far more than rounding.
  const ProgramRun run =
      run_program({"validate", "builtin:cow@1", "--lmax", "64", "--cut-off", "1e-4", "--device", "cpu"});
  CHECK(run.exit_code == 1);
  CHECK_THAT(run.out, Contains("FAILED"));
  CHECK_THAT(run.err, Contains("[check-failed]"));
}

TEST_CASE("an error in a degree that is exactly zero is stated as such, not as infinite", "[cli][estimate]") {
  const ProgramRun run = run_program({"expand", "builtin:box:1,1,1", "--lmax", "1", "--device", "cpu"});
  CHECK(run.exit_code == 0);
  CHECK_THAT(run.out, Contains(" in degree 1, exactly zero by second recursion, ") && !Contains("inf"));
}

TEST_CASE("validate states the estimated error as expand does, what a coarse cut-off leaves out included",
          "[cli][estimate]") {
  const auto lines = [](const std::vector<std::string>& command, const std::string& opening) {
    const ProgramRun run = run_program(command);
    std::istringstream text(run.out);
    std::vector<std::string> found;
    for (std::string line; std::getline(text, line);)
      if (line.starts_with(opening) && line.find("degree") < opening.size() + 1)
        found.push_back(line.substr(opening.size()));
    INFO(run.out << run.err);
    REQUIRE_FALSE(found.empty());
    return found;
  };
  for (const char* cut_off : {"1e-17", "1e-6"}) {
    const auto stated =
        lines({"validate", "builtin:cow@1", "--lmax", "64", "--cut-off", cut_off, "--device", "cpu"}, "estimate: ");
    auto expanded = lines({"expand", "builtin:cow@1", "--lmax", "64", "--cut-off", cut_off, "--device", "cpu",
                           "--verify", "full", "--origin", "com"},
                          "accuracy: ");
    expanded.erase(std::remove_if(expanded.begin(), expanded.end(),
                                  [](const std::string& line) { return line.starts_with("degrees 0 and 2 against"); }),
                   expanded.end());
    CHECK(stated == expanded);
  }
}

TEST_CASE("inspect tells what a mesh is fit for", "[cli]") {
  const TemporaryFolder folder;
  const ProgramRun good = run_program({"inspect", "builtin:cow@1"});
  CHECK(good.exit_code == 0);
  CHECK_THAT(good.out, Contains("genus 0"));
  write_text(folder / "open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const ProgramRun open = run_program({"inspect", folder / "open.off", "--json"});
  CHECK(open.exit_code == 0);
  CHECK_THAT(open.out, Contains("mesh-open") && Contains("\"open_edges\": 3"));
}

TEST_CASE("inspect calls a body fit for maps only where map takes it", "[cli]") {
  const std::string corpus = std::string(COWGPU_SOURCE) + "/tests/corpus/accepted/";
  for (const char* name : {"genus-one.off", "two-shells.off"}) {
    const ProgramRun run = run_program({"inspect", corpus + name});
    CHECK(run.exit_code == 0);
    CHECK_THAT(run.out, Contains("fit for sphere maps      no [map-topology]"));
  }
}

TEST_CASE("a command that does not exist is named", "[cli]") {
  const ProgramRun run = run_program({"frob"});
  CHECK(run.exit_code == 2);
  CHECK_THAT(run.err, Contains("'frob'") && Contains("expand"));
}
