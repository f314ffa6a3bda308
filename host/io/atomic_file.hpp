// Files that appear whole or not at all.
#pragma once

#include "host/io/output_place.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace cowgpu {

/// Writes a file so that others see the old one or the new one, never a part, also after a crash or a full disk.
///
/// The bytes go to a file without a name in the target's folder (O_TMPFILE), or where the file system has no such files to
/// a hidden one (".<name>.<random>.tmp"); only its owner may open it. commit() makes it durable and puts it in the target's
/// place. Without commit() nothing is left; kill -9 or a power cut can leave at most a hidden file.
///
/// A new file gets 0666 without the umask's bits. One that replaces a regular file of the same user takes over its mode and
/// group, but never the setuid, setgid and sticky bits; one that replaces another user's file is a new file. Links are
/// followed by the rules of output_place(), so that nobody else decides what is overwritten; a link stays, and the file it
/// leads to is replaced. What is no regular file (/dev/null, a terminal, a fifo) or an open descriptor of this process
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
  void check_replaceable();
  void open_through();
  void open_temporary();
  bool open_unnamed();
  void open_named();
  void give_mode();
  void name_unnamed();
  void copy_to_named();
  void put(std::string_view bytes);
  void discard() noexcept;

  std::filesystem::path shown_; // as the user named it
  OutputPlace place_;
  std::string temporary_; // the hidden file's name in the folder; empty while there is none
  bool through_ = false;  // written straight through
  std::string buffer_;
  int fd_ = -1;
  mode_t mode_ = 0; // mode of the whole file
};

} // namespace cowgpu
