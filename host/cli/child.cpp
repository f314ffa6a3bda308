#include "host/cli/child.hpp"

#include "host/error.hpp"
#include "host/io/output_place.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace cowgpu::cli {
namespace {

// What the child does between fork and exec.
struct Actions {
  posix_spawn_file_actions_t actions;
  Actions() { posix_spawn_file_actions_init(&actions); }
  ~Actions() { posix_spawn_file_actions_destroy(&actions); }
  Actions(const Actions&) = delete;
  Actions& operator=(const Actions&) = delete;

  void write_to(int descriptor, const Descriptor& file) {
    posix_spawn_file_actions_adddup2(&actions, file.get(), descriptor);
  }
};

// The child hears SIGTERM, by which it is told to stop, also where whoever started this process has it ignored.
struct Attributes {
  posix_spawnattr_t attributes;
  Attributes() {
    posix_spawnattr_init(&attributes);
    sigset_t heard;
    sigemptyset(&heard);
    sigaddset(&heard, SIGTERM);
    posix_spawnattr_setsigdefault(&attributes, &heard);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  }
  ~Attributes() { posix_spawnattr_destroy(&attributes); }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
};

int exit_status(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

constexpr const char* parent_variable = "COWGPU_STAGE_OF"; // the parent's process number

} // namespace

void end_with_parent() {
  const char* parent = std::getenv(parent_variable);
  if (!parent) return;
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (std::to_string(getppid()) != parent) raise(SIGTERM); // it died before
}

int run_program(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                const std::string& output, const std::string& errors, const Monitor& monitor,
                const std::function<void()>& waiting) {
  std::vector<std::string> words = {"cowgpu"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::string parent = fmt::format("{}={}", parent_variable, getpid());
  std::vector<char*> environment = {parent.data()};
  for (char** variable = environ; *variable; ++variable) environment.push_back(*variable);
  environment.push_back(nullptr);
  const Descriptor out = open_anew(folder / output), err = open_anew(folder / errors);
  const Attributes attributes;
  Actions actions;
  posix_spawn_file_actions_addchdir_np(&actions.actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  actions.write_to(STDOUT_FILENO, out);
  actions.write_to(STDERR_FILENO, err);
  pid_t process = 0;
  if (const int reason = posix_spawn(&process, "/proc/self/exe", &actions.actions, &attributes.attributes, argv.data(),
                                     environment.data()))
    throw Error(Fault::cannot_write, fmt::format("`cowgpu {}` could not be started in {}: {}", arguments[0],
                                                 folder.string(), std::strerror(reason)));
  bool told = false;
  for (;;) {
    int status = 0;
    const pid_t ended = waitpid(process, &status, WNOHANG);
    if (ended == process) {
      check_stop(monitor);
      return exit_status(status);
    }
    if (ended < 0 && errno != EINTR)
      throw Error(Fault::cannot_write, fmt::format("`cowgpu {}` was lost: {}", arguments[0], std::strerror(errno)));
    if (monitor.stopped() && !told) {
      kill(process, SIGTERM);
      told = true;
    }
    waiting();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

} // namespace cowgpu::cli
