#include "host/io/atomic_file.hpp"

#include "host/error.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <charconv>
#include <fcntl.h>
#include <optional>
#include <random>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace cowgpu {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t buffer_size = std::size_t{1} << 16;
constexpr int max_links = 40;     // as Linux
constexpr int max_tries = 100;    // for a free temporary name
constexpr std::size_t kept = 200; // characters of the name in the temporary's name, so that it stays below 255
constexpr mode_t mode_bits = 07777;

/// The number of the open descriptor that `path` stands for: /dev/fd/3, /proc/self/fd/3.
std::optional<int> own_descriptor(const fs::path& path) {
  std::error_code ignored;
  const fs::path folder = fs::canonical(path.parent_path(), ignored);
  if (ignored || folder != fs::canonical("/proc/self/fd", ignored)) return {};
  const std::string digits = path.filename().string();
  int fd = -1;
  const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), fd);
  if (result.ec != std::errc() || result.ptr != digits.data() + digits.size()) return {};
  return fd;
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

} // namespace

AtomicFile::AtomicFile(const fs::path& target) : shown_(target), target_(target) {
  if (target.empty()) fail(ENOENT);
  if (!target.has_filename()) fail(EISDIR);
  std::error_code error;
  for (int links = 0; !own_descriptor(target_) && fs::is_symlink(fs::symlink_status(target_, error)); ++links) {
    if (links == max_links) fail(ELOOP);
    const fs::path next = fs::read_symlink(target_, error);
    if (error) fail(error.value());
    target_ = folder_of(target_) / next; // an absolute `next` replaces the folder
  }

  if (const auto descriptor = own_descriptor(target_)) {
    const int flags = ::fcntl(*descriptor, F_GETFL);
    if (flags < 0) fail(errno);
    if ((flags & O_ACCMODE) == O_RDONLY) fail(EACCES);
    fd_ = ::fcntl(*descriptor, F_DUPFD_CLOEXEC, 0);
    if (fd_ < 0) fail(errno);
    return;
  }

  struct stat status {};
  if (::stat(target_.c_str(), &status) != 0) {
    if (errno != ENOENT) fail(errno);
    open_temporary();
  } else if (S_ISDIR(status.st_mode)) {
    fail(EISDIR);
  } else if (S_ISREG(status.st_mode)) {
    // Renaming would replace a file its owner has protected.
    if (::faccessat(AT_FDCWD, target_.c_str(), W_OK, AT_EACCESS) != 0) fail(errno);
    open_temporary();
    if (::fchmod(fd_, status.st_mode & mode_bits) != 0) fail(errno);
  } else {
    fd_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (fd_ < 0) fail(errno);
  }
}

AtomicFile::~AtomicFile() {
  discard();
}

// open() with O_EXCL instead of mkstemp: the kernel applies the umask, which cannot be read without a race.
void AtomicFile::open_temporary() {
  std::random_device random;
  const std::string stem = "." + target_.filename().string().substr(0, kept);
  for (int i = 0; i < max_tries; ++i) {
    const fs::path path = folder_of(target_) / fmt::format("{}.{:08x}.tmp", stem, random());
    fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd_ >= 0) {
      temporary_ = path;
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
  if (!temporary_.empty() && ::fsync(fd_) != 0) fail(errno);
  const int fd = fd_;
  fd_ = -1;
  if (::close(fd) != 0) fail(errno);
  if (temporary_.empty()) return;
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  temporary_.clear();
  // The new name is durable once its folder is. Some file systems cannot sync folders; the file itself is safe by now.
  const int folder = ::open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
}

// Also called from the constructor, where no destructor would follow.
void AtomicFile::fail(int reason) {
  discard();
  throw Error(Fault::cannot_write,
              fmt::format("{}: cannot be written: {}.", shown_.string(), std::generic_category().message(reason)));
}

void AtomicFile::discard() noexcept {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
}

} // namespace cowgpu
