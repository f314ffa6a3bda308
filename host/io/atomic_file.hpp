// Files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace cowgpu {

/// Writes a file so that others see the old one or the new one, never a part, also after a crash or a full disk.
///
/// The bytes go to a temporary file beside the target (".<name>.<random>.tmp"), which commit() makes durable and
/// renames over the target. Without commit() the destructor removes it. Only kill -9 or a power cut can leave one
/// behind.
///
/// A symbolic link stays: the file it leads to is replaced. An existing file's mode is kept, a new one gets 0666
/// without the umask's bits. What is no regular file (/dev/null, a terminal, a fifo) or an open descriptor of this
/// process
/// (/dev/stdout, /dev/fd/3) is written straight through, without these promises; opening a fifo waits for its reader.
///
/// Every failure throws Error with cannot_write, the path and the system's reason. A file-size limit (EFBIG) and a
/// closed pipe (EPIPE) raise SIGXFSZ and SIGPIPE, which kill by default: the program must ignore both.
class AtomicFile {
public:
  /// Opens. Fails here, before long work, if the folder is missing or not writable, or the target is a directory or
  /// read-only.
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends bytes; buffered, so a failure may show only in a later call.
  void write(std::string_view bytes);

  /// Flushes, syncs and renames. Afterwards the object is done: further calls throw.
  void commit();

private:
  [[noreturn]] void fail(int reason);
  void open_temporary();
  void put(std::string_view bytes);
  void discard() noexcept;

  std::filesystem::path shown_;     // as the user named it
  std::filesystem::path target_;    // behind all links
  std::filesystem::path temporary_; // empty when written straight through
  std::string buffer_;
  int fd_ = -1;
};

} // namespace cowgpu
