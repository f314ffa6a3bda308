#include "host/io/file.hpp"

#include "host/error.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <fcntl.h>
#include <new>
#include <stdexcept>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace cowgpu {
namespace {

constexpr std::size_t chunk = std::size_t{1} << 16;
constexpr std::size_t endless = std::size_t{1} << 30; // most bytes of a pipe or a device

[[noreturn]] void fail(const std::filesystem::path& path, int reason) {
  throw Error(Fault::cannot_read, fmt::format("{}: cannot be read: {}. Check the path and its permissions.",
                                              path.string(), std::generic_category().message(reason)));
}

struct FileToRead {
  int fd;
  explicit FileToRead(int value) : fd(value) {}
  FileToRead(const FileToRead&) = delete;
  FileToRead& operator=(const FileToRead&) = delete;
  ~FileToRead() {
    if (fd >= 0) ::close(fd);
  }
};

std::string read_all(int fd, const std::filesystem::path& path) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) fail(path, errno);
  if (S_ISDIR(status.st_mode)) fail(path, EISDIR);
  // The size is a first guess only: pipes have none, and files may grow while they are read. One byte more than the
  // guess lets the last read see the end.
  std::string bytes(S_ISREG(status.st_mode) ? static_cast<std::size_t>(status.st_size) + 1 : chunk, '\0');
  std::size_t size = 0;
  for (;;) {
    if (size == bytes.size()) {
      if (!S_ISREG(status.st_mode) && size > endless)
        throw Error(Fault::too_large,
                    fmt::format("{}: the file has not ended after {} GiB; name a file and not a device", path.string(),
                                size >> 30));
      bytes.resize(2 * size);
    }
    const ssize_t got = ::read(fd, bytes.data() + size, bytes.size() - size);
    if (got < 0) fail(path, errno);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  bytes.resize(size);
  return bytes;
}

} // namespace

std::string read_file(const std::filesystem::path& path) {
  const FileToRead file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.fd < 0) fail(path, errno);
  const auto too_large = [&] {
    return Error(Fault::too_large,
                 fmt::format("{}: this machine has not enough memory to hold this file.", path.string()));
  };
  try {
    return read_all(file.fd, path);
  } catch (const std::bad_alloc&) {
    throw too_large();
  } catch (const std::length_error&) {
    throw too_large();
  }
}

} // namespace cowgpu
