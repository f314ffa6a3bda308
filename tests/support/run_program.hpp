// Runs the built program as a user would.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace cowgpu::test {

struct ProgramRun {
  int exit_code = -1; ///< 128 + signal if one killed it
  std::string out, err;
};

struct ProgramOptions {
  std::map<std::string, std::string> environment; ///< set on top of this process's
  std::string stdout_to;                          ///< a file instead of a pipe
  bool close_stderr = false;
  std::string interrupt_on;   ///< SIGINT once standard error holds this
  double interrupt_after = 0; ///< seconds after which SIGINT is sent; 0: never
  double interrupt_again = 0; ///< and once more
};

/// Runs the program with `arguments` to its end; kills it after five minutes.
ProgramRun run_program(const std::vector<std::string>& arguments, const ProgramOptions& options = {});

/// A new empty folder, removed with everything in it at the end of the scope.
class TemporaryFolder {
public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  const std::string& path() const { return path_; }

private:
  std::string path_;
};

} // namespace cowgpu::test
