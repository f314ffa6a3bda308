// Where an output goes, links followed only where nobody else can have laid them.
#pragma once

#include <filesystem>
#include <string>
#include <sys/stat.h>
#include <utility>

namespace cowgpu {

/// A file descriptor, closed at the end.
class Descriptor {
public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor();
  int get() const { return fd_; }

private:
  int fd_;
};

/// A name in an open folder. The folder cannot be exchanged for another one by whoever renames folders meanwhile.
struct OutputPlace {
  Descriptor folder;     ///< O_PATH: for the *at() calls only
  std::string name;      ///< in it; no symbolic link
  bool exists = false;   ///< `name` is there
  struct stat status {}; ///< state of the file, if it exists
  int descriptor = -1; ///< the open descriptor of this process that the path stands for (/dev/stdout, /dev/fd/3), or -1
  bool magic = false;  ///< a link of /proc to something open elsewhere, which only the system can follow
};

/// Follows `path`, `links` and all. A symbolic link at the end of a path is followed if it is the user's own or root's, or
/// lies in a folder of one of them that nobody else can write to; one on the way as Linux does with protected_symlinks (in
/// folders such as /tmp, only those of the user or of the folder's owner). What is no regular file (a fifo, a device) is
/// taken by the first rule. Throws Error(cannot_write) for others, and with the system's reason for what cannot be reached.
OutputPlace output_place(const std::filesystem::path& path);

/// A new regular file of that name in place of whatever is there, open for writing (O_CLOEXEC), mode 0666 without the
/// umask's bits. Neither a link nor an old file of that name is written through. Throws Error(cannot_write).
Descriptor open_anew(const std::filesystem::path& path);

} // namespace cowgpu
