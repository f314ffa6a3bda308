#include "tests/support/run_program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

namespace cowgpu::test {
namespace {

struct Pipe {
  int ends[2] = {-1, -1};
  Pipe() {
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe");
  }
  void close_end(int which) {
    if (ends[which] >= 0) close(ends[which]);
    ends[which] = -1;
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
};

} // namespace

ProgramRun run_program(const std::vector<std::string>& arguments, const ProgramOptions& options) {
  std::vector<std::string> words = {COWGPU_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  Pipe out, err;
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork");
  if (child == 0) {
    for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
    const int sink = options.stdout_to.empty() ? out.ends[1] : open(options.stdout_to.c_str(), O_WRONLY);
    dup2(sink, STDOUT_FILENO);
    dup2(err.ends[1], STDERR_FILENO);
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    if (options.close_stderr) close(STDERR_FILENO);
    // A test that runs in the background of a script has SIGINT ignored.
    signal(SIGINT, SIG_DFL);
    execv(argv[0], argv.data());
    _exit(127);
  }
  out.close_end(1);
  err.close_end(1);

  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  std::array<double, 3> signals = {options.interrupt_after, options.interrupt_again, 300};
  ProgramRun result;
  bool interrupted = false;
  std::array<char, 65536> buffer{};
  while (out.ends[0] >= 0 || err.ends[0] >= 0) {
    for (std::size_t s = 0; s < signals.size(); ++s)
      if (signals[s] > 0 && seconds() > signals[s]) {
        kill(child, s < 2 ? SIGINT : SIGKILL);
        signals[s] = 0;
      }
    if (!interrupted && !options.interrupt_on.empty() && result.err.find(options.interrupt_on) != std::string::npos) {
      kill(child, SIGINT);
      interrupted = true;
    }
    std::array<pollfd, 2> wait = {pollfd{out.ends[0], POLLIN, 0}, pollfd{err.ends[0], POLLIN, 0}};
    poll(wait.data(), wait.size(), 20);
    const auto drain = [&](Pipe& from, const pollfd& ready, std::string& to) {
      if (from.ends[0] < 0 || !(ready.revents & (POLLIN | POLLHUP))) return;
      const ssize_t count = read(from.ends[0], buffer.data(), buffer.size());
      if (count > 0)
        to.append(buffer.data(), std::size_t(count));
      else
        from.close_end(0);
    };
    drain(out, wait[0], result.out);
    drain(err, wait[1], result.err);
  }
  int status = 0;
  waitpid(child, &status, 0);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "cowgpu-test-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("mkdtemp");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

} // namespace cowgpu::test
