#include "host/io/atomic_file.hpp"

#include "host/error.hpp"
#include "host/io/file.hpp"

#include <catch2/catch.hpp>

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <functional>
#include <iostream>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
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

// Users that are neither this process's nor root.
constexpr uid_t stranger = 54321, another = 54322;

bool is_root() {
  if (::geteuid() == 0) return true;
  std::cout << "SKIPPED: only root can make files of other users" << std::endl;
  return false;
}

void give_to(const fs::path& path, uid_t user, gid_t group = gid_t(-1)) {
  REQUIRE(::lchown(path.c_str(), user, group) == 0);
}

uid_t owner_of(const fs::path& path) {
  struct stat status {};
  REQUIRE(::lstat(path.c_str(), &status) == 0);
  return status.st_uid;
}

/// What `work` throws in a process of that user.
std::string fault_as(uid_t user, const std::function<void()>& work) {
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const bool changed = ::setgid(user) == 0 && ::setuid(user) == 0;
    const std::string fault = changed ? fault_of(work) : "no other user";
    const bool told = ::write(ends[1], fault.data(), fault.size()) == ssize_t(fault.size());
    ::_exit(told ? 0 : 1);
  }
  ::close(ends[1]);
  std::string fault(4096, '\0');
  fault.resize(std::size_t(std::max<ssize_t>(0, ::read(ends[0], fault.data(), fault.size()))));
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  return fault;
}

/// A folder in the folder, of that owner and mode.
fs::path subfolder(const Folder& folder, const char* name, uid_t owner, mode_t mode) {
  const fs::path path = folder.path / name;
  fs::create_directory(path);
  REQUIRE(::chmod(path.c_str(), mode) == 0);
  give_to(path, owner);
  return path;
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

TEST_CASE("no file is written with the setuid, setgid or sticky bit", "[atomic]") {
  const Folder folder;
  const fs::path target = folder.path / "out";
  write_plainly(target, "old");
  REQUIRE(::chmod(target.c_str(), 07755) == 0);
  write_atomically(target, "new");
  CHECK(mode_of(target) == 0755);
  CHECK(read_file(target) == "new");
}

TEST_CASE("a file that replaces another user's takes nothing over from it", "[atomic]") {
  if (!is_root()) return;
  const Folder folder;
  const mode_t old_mask = ::umask(022);
  for (const mode_t mode : {04755, 06777, 0666, 0600}) {
    const fs::path target = folder.path / std::to_string(mode);
    write_plainly(target, "old");
    give_to(target, stranger, another);
    REQUIRE(::chmod(target.c_str(), mode) == 0);
    write_atomically(target, "new");
    CHECK(mode_of(target) == 0644);
    CHECK(owner_of(target) == 0);
    CHECK(read_file(target) == "new");
  }
  ::umask(old_mask);
}

TEST_CASE("a file that was replaced keeps its group, and no other group gets its rights", "[atomic]") {
  if (!is_root()) return;
  const Folder folder;
  const fs::path target = folder.path / "out";
  struct stat status {};
  write_plainly(target, "old");
  give_to(target, 0, another);
  REQUIRE(::chmod(target.c_str(), 0660) == 0);
  write_atomically(target, "new");
  CHECK(::stat(target.c_str(), &status) == 0);
  CHECK(status.st_gid == another);
  CHECK(mode_of(target) == 0660);
  // A user who is not in that group cannot give the file to it.
  const fs::path own = subfolder(folder, "own", stranger, 0755);
  REQUIRE(::chmod(folder.path.c_str(), 0755) == 0);
  write_plainly(own / "out", "old");
  give_to(own / "out", stranger, another);
  REQUIRE(::chmod((own / "out").c_str(), 0664) == 0);
  CHECK(fault_as(stranger, [&] { write_atomically(own / "out", "new"); }) == "none");
  CHECK(::stat((own / "out").c_str(), &status) == 0);
  CHECK(status.st_gid == stranger);
  CHECK(mode_of(own / "out") == 0644);
}

TEST_CASE("what is written so far is open to nobody else", "[atomic]") {
  const Folder folder;
  const mode_t old_mask = ::umask(0);
  write_plainly(folder.path / "old", "old");
  for (const char* name : {"old", "new"}) {
    AtomicFile file(folder.path / name);
    file.write(std::string(200000, 'n'));
    std::size_t hidden = 0;
    for (const auto& entry : fs::directory_iterator(folder.path))
      if (entry.path().filename().string().starts_with(".")) {
        ++hidden;
        CHECK((mode_of(entry.path()) & 077) == 0);
      }
    CHECK(hidden <= 1);
    file.commit();
  }
  CHECK(mode_of(folder.path / "new") == 0666);
  ::umask(old_mask);
}

TEST_CASE("a link is followed only where nobody else can have laid it", "[atomic]") {
  if (!is_root()) return;
  const Folder folder;
  REQUIRE(::chmod(folder.path.c_str(), 0755) == 0);
  const fs::path target = folder.path / "precious";
  const auto refused = [&](const std::string& fault) {
    INFO(fault);
    CHECK(fault.starts_with("cannot-write: "));
    CHECK(fault.find("symbolic link of another user (number 54321)") != std::string::npos);
    CHECK(read_file(target) == "precious");
  };
  struct Case {
    const char* name;
    uid_t folder_owner;
    mode_t mode;
    uid_t link_owner;
    bool followed;
  };
  for (const Case& c :
       {Case{"sticky-stranger", 0, 01777, stranger, false}, Case{"sticky-own", 0, 01777, 0, true},
        Case{"open-stranger", 0, 0777, stranger, false}, Case{"group-stranger", 0, 0775, stranger, false},
        Case{"strangers", stranger, 0755, stranger, false}, Case{"strangers-own", stranger, 0755, 0, true},
        Case{"closed", 0, 0755, stranger, true}}) {
    INFO(c.name);
    write_plainly(target, "precious");
    const fs::path place = subfolder(folder, c.name, c.folder_owner, c.mode);
    fs::create_symlink(target, place / "out");
    give_to(place / "out", c.link_owner);
    const std::string fault = fault_of([&] { write_atomically(place / "out", "new"); });
    if (!c.followed) {
      refused(fault);
      continue;
    }
    CHECK(fault == "none");
    CHECK(read_file(target) == "new");
    CHECK(fs::is_symlink(place / "out"));
  }
  // The same for a user who is not root.
  const fs::path shared = subfolder(folder, "tmp", 0, 01777), own = subfolder(folder, "home", another, 0755);
  const auto as_another = [&](const char* name, uid_t owner) {
    fs::create_symlink(own / "file", shared / name);
    give_to(shared / name, owner);
    return fault_as(another, [&] { write_atomically(shared / name, "by another"); });
  };
  write_plainly(target, "precious");
  refused(as_another("theirs", stranger));
  CHECK_FALSE(fs::exists(own / "file"));
  CHECK(as_another("mine", another) == "none");
  CHECK(read_file(own / "file") == "by another");
}

TEST_CASE("a link on the way is not followed in a folder like /tmp if it is another user's", "[atomic]") {
  if (!is_root()) return;
  const Folder folder;
  const fs::path shared = subfolder(folder, "tmp", 0, 01777), deep = subfolder(folder, "deep", 0, 0755);
  fs::create_directory_symlink(deep, shared / "theirs");
  give_to(shared / "theirs", stranger);
  CHECK(cannot_write([&] { write_atomically(shared / "theirs/out", "x"); },
                     "'theirs' is a symbolic link of another user"));
  CHECK_FALSE(fs::exists(deep / "out"));
  fs::create_directory_symlink("../deep", shared / "mine");
  write_atomically(shared / "mine/../deep/./out", "x");
  CHECK(read_file(deep / "out") == "x");
}

TEST_CASE("a fifo of another user in a folder open to all is not written to", "[atomic]") {
  if (!is_root()) return;
  const Folder folder;
  const fs::path shared = subfolder(folder, "tmp", 0, 01777);
  REQUIRE(::mkfifo((shared / "fifo").c_str(), 0666) == 0);
  give_to(shared / "fifo", stranger);
  CHECK(cannot_write([&] { AtomicFile file(shared / "fifo"); }, "a fifo or a device of another user"));
}

TEST_CASE("in a folder like /tmp another user's file is refused before long work", "[atomic]") {
  if (!is_root()) return;
  const Folder folder;
  REQUIRE(::chmod(folder.path.c_str(), 0755) == 0);
  const fs::path shared = subfolder(folder, "tmp", 0, 01777);
  write_plainly(shared / "out", "old");
  give_to(shared / "out", stranger);
  REQUIRE(::chmod((shared / "out").c_str(), 0666) == 0);
  CHECK(fault_as(another, [&] { AtomicFile file(shared / "out"); }).find("Operation not permitted") !=
        std::string::npos);
}

TEST_CASE("a file made anew stands in place of a link or a file, and writes through neither", "[atomic]") {
  const Folder folder;
  write_plainly(folder.path / "precious", "precious");
  fs::create_symlink("precious", folder.path / "link");
  fs::create_hard_link(folder.path / "precious", folder.path / "hard");
  for (const char* name : {"link", "hard"}) {
    const Descriptor file = open_anew(folder.path / name);
    REQUIRE(::write(file.get(), "new", 3) == 3);
    CHECK(read_file(folder.path / name) == "new");
    CHECK(read_file(folder.path / "precious") == "precious");
    CHECK(fs::symlink_status(folder.path / name).type() == fs::file_type::regular);
  }
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
