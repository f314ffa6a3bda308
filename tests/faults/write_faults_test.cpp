// Files while the program is killed, and on a disk that is full: the old one or the new one, never a part.
#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

using namespace cowgpu::test;
using Catch::Contains;

namespace {

// Runs the program and kills it after that many milliseconds; whether it was killed before its end.
bool killed(const std::vector<std::string>& arguments, int milliseconds) {
  std::vector<std::string> all = {COWGPU_PROGRAM};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& a : all) argv.push_back(a.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    dup2(open("/dev/null", O_WRONLY), STDOUT_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}

// A limit of the size of every file that this process and its children write.
struct FileSizeLimit {
  rlimit before{};
  explicit FileSizeLimit(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before);
    rlimit now = before;
    now.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, SIG_DFL);
  }
};

} // namespace

TEST_CASE("a program killed at any time leaves the old file or the whole new one", "[write-faults][cli]") {
  const TemporaryFolder folder;
  const std::string path = folder / "out.json";
  const std::vector<std::string> command = {"expand",   "builtin:box", "--lmax", "700", "--device", "cpu",
                                            "--verify", "none",        "-q",     "-o",  path};
  REQUIRE(run_program(command).exit_code == 0);
  const std::string whole = read_text(path);
  const std::string tail = whole.substr(whole.size() - 40);
  std::mt19937 random(11);
  int before_the_end = 0, after_a_write = 0;
  for (int i = 0; i < 24; ++i) {
    std::ofstream(path, std::ios::binary) << "old";
    const int time = std::uniform_int_distribution<int>(0, 400)(random);
    INFO("killed after " << time << " ms");
    before_the_end += killed(command, time);
    const std::string now = read_text(path);
    if (now == "old") continue;
    ++after_a_write;
    // Times and dates differ, so lengths may a little; a part would lack the end.
    CHECK((now.size() + 200 > whole.size() && now.size() < whole.size() + 200));
    CHECK(now.substr(now.size() - 40) == tail);
  }
  CHECK(before_the_end > 4);
  INFO(after_a_write << " of 24 runs had written");
}

TEST_CASE("a full disk is exit code 5 for every kind of file, and the old file stays", "[write-faults][cli]") {
  const TemporaryFolder folder;
  const std::string grid = folder / "grid.nc", moments = folder / "moments.csv";
  REQUIRE(run_program({"expand", "builtin:box", "--lmax", "60", "--device", "cpu", "-q", "-o", moments}).exit_code ==
          0);
  const std::vector<std::pair<std::string, std::vector<std::string>>> commands = {
      {"a.json", {"expand", "builtin:box", "--lmax", "60"}},
      {"a.csv", {"expand", "builtin:box", "--lmax", "60"}},
      {"a.nc", {"transform", "synthesise", moments, "{}", "--lmax", "60"}},
      {"b.csv", {"transform", "synthesise", moments, "{}", "--lmax", "60"}},
      {"a.ply", {"map", "builtin:sphere@3", "--method", "harmonic"}},
      {"a.glb", {"map", "builtin:sphere@3", "--method", "harmonic"}},
      {"b.glb", {"reconstruct", "builtin:sphere@3", "--order", "4"}},
      {"a.png", {"render", "builtin:cow", "--width", "300", "--height", "300"}},
      {"c.csv", {"distance", "builtin:box", "--grid", "12"}},
      {"b.nc", {"distance", "builtin:box", "--grid", "12"}},
      {"c.glb", {"inflate", "builtin:box", "--levels", "0.3", "--cells", "24"}},
      {"d.csv", {"streamlines", "builtin:sphere@3", "--plane", "xy", "--count", "200"}},
      {"a.vtp", {"surface", "builtin:sphere@2"}},
      {"b.ply", {"surface", "builtin:sphere@2"}},
      {"d.glb", {"surface", "builtin:sphere@2", "--at", "vertices"}},
      {"e.csv", {"surface", "builtin:sphere@2"}},
      {"c.nc", {"surface", "builtin:sphere@2"}},
  };
  for (const auto& [name, command] : commands) {
    const std::string path = folder / name;
    std::vector<std::string> arguments = command;
    bool named = false;
    for (std::string& a : arguments)
      if (a == "{}") a = path, named = true;
    if (!named) arguments.insert(arguments.end(), {"-o", path});
    arguments.insert(arguments.end(), {"--device", "cpu", "-q"});
    std::ofstream(path, std::ios::binary) << "old";
    ProgramRun run;
    {
      const FileSizeLimit limit(4096);
      run = run_program(arguments);
    }
    INFO(name << ": " << run.err);
    CHECK(run.exit_code == 5);
    CHECK_THAT(run.err, Contains("cannot-write") && Contains(name));
    CHECK(read_text(path) == "old");
    CHECK(run_program(arguments).exit_code == 0); // and with room it works
    CHECK(read_text(path) != "old");
  }
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    INFO(entry.path());
    ++files;
  }
  CHECK(files == commands.size() + 2); // the moments, and the JSON beside the values
}
