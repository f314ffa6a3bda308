#include "host/io/atomic_file.hpp"

#include "host/error.hpp"
#include "host/io/file.hpp"

#include <catch2/catch.hpp>

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <functional>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

using namespace cowgpu;
namespace fs = std::filesystem;

namespace {

/// A folder that goes away with the test.
struct Folder {
  fs::path path;
  Folder() {
    std::string name = (fs::temp_directory_path() / "cowgpu-test-XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { fs::remove_all(path); }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(path), fs::directory_iterator()));
  }
};

void write_plainly(const fs::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

void write_atomically(const fs::path& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

std::string fault_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return std::string(name(error.fault())) + ": " + error.what();
  }
  return "none";
}

bool cannot_write(const std::function<void()>& work, const std::string& reason) {
  const std::string fault = fault_of(work);
  INFO(fault);
  const bool as_expected = fault.starts_with("cannot-write: ") && fault.find(reason) != std::string::npos;
  CHECK(as_expected);
  return as_expected;
}

mode_t mode_of(const fs::path& path) {
  struct stat status {};
  REQUIRE(::stat(path.c_str(), &status) == 0);
  return status.st_mode & 07777;
}

/// Limits the size of files; the signal must not kill.
struct FileSizeLimit {
  rlimit old{};
  void (*handler)(int);
  explicit FileSizeLimit(rlim_t size) : handler(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old);
    const rlimit limit{size, old.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, handler);
  }
};

} // namespace

TEST_CASE("a file appears with commit, whole", "[atomic]") {
  const Folder folder;
  const fs::path target = folder.path / "out.json";
  std::string expected;
  AtomicFile file(target);
  for (int i = 0; i < 30000; ++i) {
    const std::string piece = std::to_string(i) + "\n";
    file.write(piece);
    expected += piece;
  }
  const std::string large(300000, 'x');
  file.write(large);
  CHECK_FALSE(fs::exists(target));
  file.commit();
  CHECK(read_file(target) == expected + large);
  CHECK(folder.entries() == 1);
}

TEST_CASE("without commit the old file stays and no temporary is left", "[atomic]") {
  const Folder folder;
  const fs::path target = folder.path / "out";
  write_plainly(target, "old");
  {
    AtomicFile file(target);
    file.write(std::string(200000, 'n'));
    CHECK(read_file(target) == "old");
  }
  CHECK(read_file(target) == "old");
  CHECK(folder.entries() == 1);
  { const AtomicFile file(folder.path / "another"); }
  CHECK(folder.entries() == 1);
}

TEST_CASE("a file-size limit keeps the old file and leaves no temporary", "[atomic]") {
  const Folder folder;
  const fs::path target = folder.path / "out";
  write_plainly(target, "old");
  {
    const FileSizeLimit limit(4096);
    CHECK(cannot_write([&] { write_atomically(target, std::string(1 << 20, 'n')); }, "File too large"));
    // Small enough for the buffer: the failure shows in commit().
    CHECK(cannot_write([&] { write_atomically(target, std::string(10000, 'n')); }, "File too large"));
    CHECK(folder.entries() == 1);
  }
  CHECK(read_file(target) == "old");
}

TEST_CASE("a full device is told", "[atomic]") {
  if (!fs::exists("/dev/full")) return;
  CHECK(cannot_write([] { write_atomically("/dev/full", "x"); }, "No space left"));
}

TEST_CASE("a file that was replaced keeps its mode, a new one obeys the umask", "[atomic]") {
  const Folder folder;
  const mode_t old_mask = ::umask(027);
  write_atomically(folder.path / "new", "x");
  CHECK(mode_of(folder.path / "new") == 0640);
  ::chmod((folder.path / "new").c_str(), 0604);
  write_atomically(folder.path / "new", "y");
  CHECK(mode_of(folder.path / "new") == 0604);
  ::umask(old_mask);
}

TEST_CASE("a symbolic link stays and its file is replaced", "[atomic]") {
  const Folder folder;
  fs::create_directory(folder.path / "deep");
  write_plainly(folder.path / "deep/file", "old");
  fs::create_symlink("deep/file", folder.path / "relative");
  fs::create_symlink(folder.path / "relative", folder.path / "absolute");
  write_atomically(folder.path / "absolute", "new");
  CHECK(fs::is_symlink(folder.path / "absolute"));
  CHECK(fs::is_symlink(folder.path / "relative"));
  CHECK(read_file(folder.path / "deep/file") == "new");

  fs::create_symlink("deep/later", folder.path / "dangling");
  write_atomically(folder.path / "dangling", "late");
  CHECK(read_file(folder.path / "deep/later") == "late");

  fs::create_symlink("loop", folder.path / "loop");
  CHECK(cannot_write([&] { AtomicFile file(folder.path / "loop"); }, "symbolic links"));
}

TEST_CASE("what cannot be written fails when opened", "[atomic]") {
  const Folder folder;
  CHECK(cannot_write([&] { AtomicFile file(folder.path / "missing/out"); }, "No such file"));
  CHECK(cannot_write([&] { AtomicFile file(folder.path); }, "Is a directory"));
  CHECK(cannot_write([&] { AtomicFile file(folder.path / ""); }, "Is a directory"));
  CHECK(cannot_write([&] { AtomicFile file(""); }, "No such file"));
  write_plainly(folder.path / "file", "x");
  CHECK(cannot_write([&] { AtomicFile file(folder.path / "file/out"); }, "Not a directory"));
  CHECK(cannot_write([&] { AtomicFile file(folder.path / std::string(300, 'n')); }, "File name too long"));
  if (::geteuid() != 0) { // root may write anywhere
    ::chmod((folder.path / "file").c_str(), 0444);
    CHECK(cannot_write([&] { AtomicFile file(folder.path / "file"); }, "Permission denied"));
    fs::create_directory(folder.path / "closed");
    ::chmod((folder.path / "closed").c_str(), 0555);
    CHECK(cannot_write([&] { AtomicFile file(folder.path / "closed/out"); }, "Permission denied"));
  }
  CHECK(folder.entries() <= 2);
}

TEST_CASE("names as long as the system allows can be written", "[atomic]") {
  const Folder folder;
  const fs::path target = folder.path / std::string(255, 'n');
  write_atomically(target, "x");
  CHECK(read_file(target) == "x");
}

TEST_CASE("after commit and after a failure further calls fail", "[atomic]") {
  const Folder folder;
  AtomicFile file(folder.path / "out");
  file.commit();
  CHECK(cannot_write([&] { file.write("x"); }, "out"));
  CHECK(cannot_write([&] { file.commit(); }, "out"));
  CHECK(read_file(folder.path / "out").empty());
}

TEST_CASE("devices, fifos and open descriptors are written straight through", "[atomic]") {
  write_atomically("/dev/null", "gone");
  CHECK(fs::is_character_file("/dev/null"));

  const Folder folder;
  const fs::path fifo = folder.path / "fifo";
  REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
  std::string received;
  std::thread reader([&] { received = read_file(fifo); });
  write_atomically(fifo, "through");
  reader.join();
  CHECK(received == "through");
  CHECK(fs::is_fifo(fifo));

  // A regular file behind a descriptor keeps what was written to the descriptor before.
  const fs::path target = folder.path / "redirected";
  const int fd = ::open(target.c_str(), O_WRONLY | O_CREAT, 0600);
  REQUIRE(::write(fd, "first ", 6) == 6);
  write_atomically("/dev/fd/" + std::to_string(fd), "second ");
  write_atomically("/proc/self/fd/" + std::to_string(fd), "third");
  ::close(fd);
  CHECK(read_file(target) == "first second third");
  CHECK(cannot_write([&] { AtomicFile file("/dev/fd/" + std::to_string(fd)); }, "Bad file descriptor"));
  CHECK(folder.entries() == 2);
}

TEST_CASE("files are read whole or the reason is told", "[file]") {
  const Folder folder;
  const std::string bytes("a\0b\r\n", 5);
  write_plainly(folder.path / "file", bytes);
  CHECK(read_file(folder.path / "file") == bytes);
  write_plainly(folder.path / "empty", "");
  CHECK(read_file(folder.path / "empty").empty());
  CHECK(!read_file("/proc/self/status").empty()); // says it has no size
  CHECK(fault_of([&] { read_file(folder.path / "none"); }).find("cannot-read: " + folder.path.string()) == 0);
  CHECK(fault_of([&] { read_file(folder.path / "none"); }).find("No such file") != std::string::npos);
  CHECK(fault_of([&] { read_file(folder.path); }).find("Is a directory") != std::string::npos);
  if (::geteuid() != 0) {
    ::chmod((folder.path / "file").c_str(), 0);
    CHECK(fault_of([&] { read_file(folder.path / "file"); }).find("Permission denied") != std::string::npos);
  }
}
