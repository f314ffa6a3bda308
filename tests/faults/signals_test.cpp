// Signals to the program and to the library: what ends, what stays, what is left.
#include "host/error.hpp"
#include "host/map/solve.hpp"
#include "host/signals.hpp"
#include "tests/support/fields.hpp"
#include "tests/support/run_program.hpp"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <thread>

using namespace cowgpu;
using namespace cowgpu::test;
using Catch::Contains;

namespace {

void rest(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

// The program at work: it reads a mesh from a fifo, and goes on once it gets one.
class Waiting {
public:
  explicit Waiting(int ignored = 0) {
    const std::string fifo = folder_ / "fifo", out = folder_ / "out.json";
    REQUIRE(mkfifo(fifo.c_str(), 0600) == 0);
    write_text(out, "old");
    child_ = fork();
    REQUIRE(child_ >= 0);
    if (child_ == 0) {
      for (const int number : {SIGHUP, SIGINT, SIGTERM}) std::signal(number, number == ignored ? SIG_IGN : SIG_DFL);
      dup2(open("/dev/null", O_WRONLY), STDOUT_FILENO);
      dup2(open((folder_ / "err").c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
      execl(COWGPU_PROGRAM, "cowgpu", "expand", fifo.c_str(), "--lmax", "2", "--device", "cpu", "-o", out.c_str(),
            static_cast<char*>(nullptr));
      _exit(127);
    }
    for (int tries = 0; (mesh_ = open(fifo.c_str(), O_WRONLY | O_NONBLOCK)) < 0 && tries < 6000; ++tries) rest(10);
    REQUIRE(mesh_ >= 0); // it has opened the other end
  }

  void send(int signal) const { kill(child_, signal); }

  /// Gives it that mesh, and returns how it ended.
  int end(const std::string& mesh) {
    rest(20);
    std::signal(SIGPIPE, SIG_IGN);
    if (!mesh.empty()) CHECK(write(mesh_, mesh.data(), mesh.size()) == ssize_t(mesh.size()));
    close(mesh_);
    int status = 0;
    waitpid(child_, &status, 0);
    return status;
  }

  std::string said() const { return read_text(folder_ / "err"); }
  std::string result() const { return read_text(folder_ / "out.json"); }
  std::size_t files() const {
    return std::size_t(std::distance(std::filesystem::directory_iterator(folder_.path()), {}));
  }

private:
  TemporaryFolder folder_;
  pid_t child_ = -1;
  int mesh_ = -1;
};

constexpr const char* tetrahedron = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

// Of a square grid, with 1 more on the diagonal.
SparseMatrix grid_laplacian(int side) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const int at = i * side + j;
      entries.emplace_back(at, at, 5);
      if (i + 1 < side) entries.emplace_back(at, at + side, -1), entries.emplace_back(at + side, at, -1);
      if (j + 1 < side) entries.emplace_back(at, at + 1, -1), entries.emplace_back(at + 1, at, -1);
    }
  SparseMatrix matrix(side * side, side * side);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

std::atomic<int> terminations = 0;

} // namespace

TEST_CASE("every signal that ends programs ends work with 128 + its number, and leaves the old file alone",
          "[signals][cli]") {
  for (const int signal :
       {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGXCPU, SIGIO, SIGRTMIN, SIGRTMAX}) {
    INFO(strsignal(signal));
    Waiting program;
    program.send(signal);
    const int status = program.end("");
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 128 + signal);
    CHECK_THAT(program.said(), Contains("error [interrupted]"));
    CHECK(program.result() == "old");
    CHECK(program.files() == 3); // fifo, err, out.json
  }
}

TEST_CASE("a signal that comes twice at once is one wish to stop", "[signals][cli]") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Waiting program;
    program.send(signal);
    rest(5);
    program.send(signal);
    const int status = program.end("");
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 128 + signal);
  }
}

TEST_CASE("a signal that was ignored when the program began stays ignored", "[signals][cli]") {
  for (const int signal : {SIGINT, SIGHUP, SIGTERM}) {
    INFO(strsignal(signal));
    Waiting program(signal);
    program.send(signal);
    const int status = program.end(tetrahedron);
    INFO(program.said());
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
    CHECK_THAT(program.result(), Contains("cowgpu.result.v1"));
  }
}

TEST_CASE("SIGTERM while METIS orders a matrix is a wish to stop and no lack of memory", "[signals][map]") {
  struct Stopper : Monitor {
    bool stopped() const override { return terminations > 0; }
  } monitor;
  const SparseMatrix matrix = grid_laplacian(300);
  struct sigaction ours {
  }, before{};
  ours.sa_handler = [](int) { ++terminations; };
  terminations = 0;
  REQUIRE(sigaction(SIGTERM, &ours, &before) == 0);
  std::atomic<bool> ended = false;
  std::thread sender;
  {
    const HeldSignals for_the_caller;
    sender = std::thread([&] {
      rest(20);
      for (int i = 0; i < 100 && !ended; ++i) {
        kill(getpid(), SIGTERM);
        rest(2);
      }
    });
  }
  Fault fault = Fault::check_failed;
  std::string said = "it was not stopped";
  try {
    for (int i = 0; i < 50; ++i) const SymmetricSolver solver(matrix, "a grid", Ordering::nested_dissection, monitor);
  } catch (const Error& error) {
    fault = error.fault();
    said = error.what();
  }
  ended = true;
  sender.join();
  struct sigaction there {};
  REQUIRE(sigaction(SIGTERM, &before, &there) == 0);
  INFO(said);
  CHECK(fault == Fault::interrupted);
  CHECK(there.sa_handler == ours.sa_handler);
  CHECK(terminations > 0);
}
