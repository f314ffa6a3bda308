#include "host/io/atomic_file.hpp"

#include "host/error.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <fcntl.h>
#include <random>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace cowgpu {
namespace {

constexpr std::size_t buffer_size = std::size_t{1} << 16;
constexpr int max_tries = 100;    // for a free temporary name
constexpr std::size_t kept = 200; // characters of the name in the temporary's name, so that it stays below 255
constexpr mode_t mode_bits = 0777, only_owner = 0600;

std::string hidden_name(const std::string& name) {
  static thread_local std::random_device random;
  return fmt::format(".{}.{:08x}.tmp", name.substr(0, kept), random());
}

std::string path_of(int fd) {
  return fmt::format("/proc/self/fd/{}", fd);
}

} // namespace

AtomicFile::AtomicFile(const std::filesystem::path& target) : shown_(target), place_(output_place(target)) {
  if (place_.descriptor >= 0) {
    through_ = true;
    const int flags = ::fcntl(place_.descriptor, F_GETFL);
    if (flags < 0) fail(errno);
    if ((flags & O_ACCMODE) == O_RDONLY) fail(EACCES);
    fd_ = ::fcntl(place_.descriptor, F_DUPFD_CLOEXEC, 0);
    if (fd_ < 0) fail(errno);
  } else if (place_.magic || (place_.exists && !S_ISREG(place_.status.st_mode))) {
    open_through();
  } else {
    if (place_.exists) check_replaceable();
    open_temporary();
  }
}

AtomicFile::~AtomicFile() {
  discard();
}

// What renaming would do or refuse only after long work.
void AtomicFile::check_replaceable() {
  // It would replace a file its owner has protected.
  if (::faccessat(place_.folder.get(), place_.name.c_str(), W_OK, AT_EACCESS) != 0) fail(errno);
  struct stat folder {};
  if (::fstat(place_.folder.get(), &folder) != 0) fail(errno);
  const uid_t user = ::geteuid();
  if ((folder.st_mode & S_ISVTX) && user != 0 && user != folder.st_uid && user != place_.status.st_uid) fail(EPERM);
}

void AtomicFile::open_through() {
  through_ = true;
  if (S_ISDIR(place_.status.st_mode)) fail(EISDIR);
  const int follow = place_.magic ? O_TRUNC : O_NOFOLLOW;
  fd_ = ::openat(place_.folder.get(), place_.name.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY | follow);
  if (fd_ < 0) fail(errno);
  struct stat now {};
  if (::fstat(fd_, &now) != 0) fail(errno);
  // Another thing may have been put there meanwhile.
  if (!place_.magic && (now.st_dev != place_.status.st_dev || now.st_ino != place_.status.st_ino)) fail(ESTALE);
}

void AtomicFile::open_temporary() {
  if (!open_unnamed()) open_named();
  // The system has applied the umask, which cannot be read without a race.
  struct stat made {};
  if (::fstat(fd_, &made) != 0) fail(errno);
  mode_ = made.st_mode & mode_bits;
  const bool take_over = place_.exists && place_.status.st_uid == made.st_uid;
  if (take_over) mode_ = place_.status.st_mode & mode_bits;
  if (::fchmod(fd_, only_owner) != 0) fail(errno);
  if (!take_over || place_.status.st_gid == made.st_gid) return;
  // Another group gets what everybody gets.
  if (::fchown(fd_, uid_t(-1), place_.status.st_gid) != 0) mode_ = (mode_ & 0707) | (mode_ & 0007) << 3;
}

bool AtomicFile::open_unnamed() {
  fd_ = ::openat(place_.folder.get(), ".", O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (fd_ < 0) return false; // the named one tells the reason, if there is one
  if (::access(path_of(fd_).c_str(), F_OK) == 0) return true;
  ::close(fd_); // without /proc it cannot get a name
  fd_ = -1;
  return false;
}

void AtomicFile::open_named() {
  // A file that takes over a mode is at no time open to more than its owner.
  const mode_t mode = place_.exists && place_.status.st_uid == ::geteuid() ? only_owner : 0666;
  for (int i = 0; i < max_tries; ++i) {
    const std::string name = hidden_name(place_.name);
    fd_ = ::openat(place_.folder.get(), name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    if (fd_ >= 0) {
      temporary_ = name;
      return;
    }
    if (errno != EEXIST) fail(errno);
  }
  fail(EEXIST);
}

void AtomicFile::write(std::string_view bytes) {
  if (fd_ < 0) fail(EBADF);
  if (buffer_.size() + bytes.size() > buffer_size) {
    put(buffer_);
    buffer_.clear();
    if (bytes.size() > buffer_size) return put(bytes);
  }
  buffer_ += bytes;
}

void AtomicFile::put(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(fd_, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail(errno);
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
}

void AtomicFile::commit() {
  if (fd_ < 0) fail(EBADF);
  put(buffer_);
  buffer_.clear();
  if (!through_) {
    if (::fchmod(fd_, mode_) != 0 || ::fsync(fd_) != 0) fail(errno);
    if (temporary_.empty()) name_unnamed();
  }
  const int fd = fd_;
  fd_ = -1;
  if (::close(fd) != 0) fail(errno);
  if (temporary_.empty()) return;
  if (::renameat(place_.folder.get(), temporary_.c_str(), place_.folder.get(), place_.name.c_str()) != 0) fail(errno);
  temporary_.clear();
  // The new name is durable once its folder is. Some file systems cannot sync folders; the file itself is safe by now.
  const int folder = ::openat(place_.folder.get(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
}

// A hidden name, since a link cannot replace a file.
void AtomicFile::name_unnamed() {
  for (int i = 0; i < max_tries; ++i) {
    const std::string name = hidden_name(place_.name);
    if (::linkat(AT_FDCWD, path_of(fd_).c_str(), place_.folder.get(), name.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      temporary_ = name;
      return;
    }
    if (errno != EEXIST) break;
  }
  copy_to_named();
}

// For file systems that make files without a name and cannot name them.
void AtomicFile::copy_to_named() {
  const int from = fd_;
  const Descriptor closer(from);
  fd_ = -1;
  open_named();
  std::vector<char> bytes(buffer_size);
  for (off_t at = 0;;) {
    const ssize_t got = ::pread(from, bytes.data(), bytes.size(), at);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(errno);
    if (got == 0) break;
    put({bytes.data(), std::size_t(got)});
    at += got;
  }
  if (::fchmod(fd_, mode_) != 0 || ::fsync(fd_) != 0) fail(errno);
}

// Also called from the constructor, where no destructor would follow.
void AtomicFile::fail(int reason) {
  discard();
  throw Error(
      Fault::cannot_write,
      fmt::format(
          "{}: cannot be written: {}. Check the folder, its permissions and its free space, or name another file.",
          shown_.string(), std::generic_category().message(reason)));
}

void AtomicFile::discard() noexcept {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
  if (!temporary_.empty()) ::unlinkat(place_.folder.get(), temporary_.c_str(), 0);
  temporary_.clear();
}

} // namespace cowgpu
