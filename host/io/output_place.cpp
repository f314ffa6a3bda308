#include "host/io/output_place.hpp"

#include "host/error.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <deque>
#include <fcntl.h>
#include <linux/magic.h>
#include <sys/vfs.h>
#include <system_error>
#include <unistd.h>

namespace cowgpu {
namespace {

namespace fs = std::filesystem;

constexpr int max_links = 40; // as Linux
constexpr std::size_t longest_link = 1 << 16;

[[noreturn]] void refuse(const fs::path& path, int reason) {
  throw Error(
      Fault::cannot_write,
      fmt::format(
          "{}: cannot be written: {}. Check the folder, its permissions and its free space, or name another file.",
          path.string(), std::generic_category().message(reason)));
}

// Root can do everything anyway.
bool trusted(uid_t owner) {
  return owner == ::geteuid() || owner == 0;
}

// Whether nobody else can have put `there` into `folder`.
bool laid_by_us(const struct stat& there, const struct stat& folder) {
  return trusted(there.st_uid) || (trusted(folder.st_uid) && !(folder.st_mode & (S_IWOTH | S_IWGRP)));
}

bool protected_by_linux(const struct stat& link, const struct stat& folder) {
  const bool shared = (folder.st_mode & S_ISVTX) && (folder.st_mode & S_IWOTH);
  return shared && link.st_uid != ::geteuid() && link.st_uid != folder.st_uid;
}

bool in_proc(int fd) {
  struct statfs system {};
  return ::fstatfs(fd, &system) == 0 && system.f_type == PROC_SUPER_MAGIC;
}

bool same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

std::deque<std::string> parts_of(const std::string& path) {
  std::deque<std::string> parts;
  std::size_t begin = path.starts_with('/') ? 1 : 0;
  for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = path.find('/', begin);
    parts.push_back(path.substr(begin, end - begin));
  }
  return parts;
}

class Walk {
public:
  explicit Walk(const fs::path& path) : path_(path) {}

  OutputPlace end() {
    start_at(path_.string());
    std::deque<std::string> parts = parts_of(path_.string());
    while (!parts.empty()) {
      place_.name = std::move(parts.front());
      parts.pop_front();
      const bool last = parts.empty();
      if (place_.name.empty() || place_.name == "." || place_.name == "..") {
        if (last) refuse(path_, EISDIR);
        if (place_.name == "..") enter("..");
        continue;
      }
      if (last && is_own_descriptor()) return std::move(place_);
      Descriptor there(::openat(place_.folder.get(), place_.name.c_str(), O_PATH | O_NOFOLLOW | O_CLOEXEC));
      if (there.get() < 0) {
        if (last && errno == ENOENT) return std::move(place_);
        refuse(path_, errno);
      }
      if (::fstat(there.get(), &place_.status) != 0) refuse(path_, errno);
      if (S_ISLNK(place_.status.st_mode)) {
        if (++links_ > max_links) refuse(path_, ELOOP);
        if (in_proc(there.get())) { // its text is not always where it leads to
          place_.magic = last;
          if (last) return std::move(place_);
          enter(place_.name.c_str());
          continue;
        }
        check_link(last);
        const std::string to = text_of(there.get());
        const std::deque<std::string> more = parts_of(to);
        parts.insert(parts.begin(), more.begin(), more.end());
        if (to.starts_with('/')) start_at(to);
      } else if (!last) {
        if (!S_ISDIR(place_.status.st_mode)) refuse(path_, ENOTDIR);
        place_.folder = std::move(there);
      }
    }
    place_.exists = true;
    if (!S_ISREG(place_.status.st_mode) && !S_ISDIR(place_.status.st_mode) && !laid_by_us(place_.status, folder()))
      throw Error(
          Fault::cannot_write,
          fmt::format("{}: this is not a file but a fifo or a device of another user (number {}), in a folder where "
                      "others can put such things: nothing is written to it; give another name",
                      path_.string(), place_.status.st_uid));
    return std::move(place_);
  }

private:
  void start_at(const std::string& path) {
    place_.folder = Descriptor(::open(path.starts_with('/') ? "/" : ".", O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (place_.folder.get() < 0) refuse(path_, errno);
  }

  void enter(const char* name) {
    Descriptor next(::openat(place_.folder.get(), name, O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (next.get() < 0) refuse(path_, errno);
    place_.folder = std::move(next);
  }

  struct stat folder() const {
    struct stat status {};
    if (::fstat(place_.folder.get(), &status) != 0) refuse(path_, errno);
    return status;
  }

  bool is_own_descriptor() {
    struct stat ours {};
    if (!in_proc(place_.folder.get()) || ::stat("/proc/self/fd", &ours) != 0 || !same_file(folder(), ours))
      return false;
    const char *begin = place_.name.data(), *end = begin + place_.name.size();
    int fd = -1;
    const auto result = std::from_chars(begin, end, fd);
    if (result.ec != std::errc() || result.ptr != end) return false;
    if (fd == place_.folder.get()) refuse(path_, EBADF); // it has taken that number just now
    place_.descriptor = fd;
    return true;
  }

  void check_link(bool last) const {
    if (last ? laid_by_us(place_.status, folder()) : !protected_by_linux(place_.status, folder())) return;
    throw Error(Fault::cannot_write,
                fmt::format("{}: '{}' is a symbolic link of another user (number {}), in a folder where others can put "
                            "links: it is not followed; give the path that it leads to, or remove it",
                            path_.string(), place_.name, place_.status.st_uid));
  }

  std::string text_of(int link) const {
    std::string text(longest_link, '\0');
    const ssize_t length = ::readlinkat(link, "", text.data(), text.size());
    if (length <= 0) refuse(path_, length < 0 ? errno : ENOENT);
    text.resize(std::size_t(length));
    return text;
  }

  const fs::path& path_;
  OutputPlace place_;
  int links_ = 0;
};

} // namespace

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

OutputPlace output_place(const fs::path& path) {
  if (path.empty()) refuse(path, ENOENT);
  return Walk(path).end();
}

Descriptor open_anew(const fs::path& path) {
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) refuse(path, errno);
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (file.get() < 0) refuse(path, errno);
  return file;
}

} // namespace cowgpu
