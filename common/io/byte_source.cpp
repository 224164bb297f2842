// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/byte_source.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <deque>
#include <string>
#include <vector>

#include "common/io/byte_sink.hpp"
#include "common/io/fd_writing.hpp"

namespace rtd::io {
namespace fs = std::filesystem;
namespace {

std::string kind_of(mode_t mode) {
  return S_ISFIFO(mode) ? "a pipe" : S_ISSOCK(mode) ? "a socket" : "a device";
}

std::string leads_out(const fs::path& below) {
  return ": leads out of the folder " + below.string() + ", below which the files of others must lie";
}

/// Opens what a path names, part by part from the descriptor of a folder that it does not leave: what was checked is
/// what is opened, even where another process replaces folders by links meanwhile.
class Resolution {
 public:
  Resolution(const fs::path& below, int flags) : below_(below), flags_(flags) {
    folders_.emplace_back(::open(below.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  }

  /// Returns the descriptor, or -1 and sets errno: EXDEV where it leads out.
  int open(const fs::path& path) {
    if (folders_.front().get() < 0) return -1;
    if (!push(path.lexically_relative(below_))) return out();
    while (!todo_.empty()) {
      const std::string part = std::move(todo_.back());
      todo_.pop_back();
      if (part.empty() || part == ".") continue;
      if (part != "..") {
        const int fd = enter(part);
        if (fd != kEntered) return fd;
      } else if (folders_.size() > 1) {
        folders_.pop_back();
      } else {
        return out();
      }
    }
    return ::openat(folders_.back().get(), ".", flags_);
  }

 private:
  static constexpr int kEntered = -2, kMostLinks = 40;  // as many as Linux follows

  static int out() {
    errno = EXDEV;
    return -1;
  }

  /// False where the path leads out already as it is written.
  bool push(const fs::path& relative) {
    if (relative.empty() || relative.is_absolute()) return false;
    const std::vector<fs::path> parts(relative.begin(), relative.end());
    for (auto part = parts.rbegin(); part != parts.rend(); ++part) todo_.push_back(part->string());
    return true;
  }

  /// Enters a folder or a link, or opens the last part.
  int enter(const std::string& part) {
    std::string target(PATH_MAX, '\0');
    const ssize_t size = ::readlinkat(folders_.back().get(), part.c_str(), target.data(), target.size());
    if (size >= 0 && (flags_ & O_NOFOLLOW) == 0) return follow(target.substr(0, static_cast<std::size_t>(size)));
    const bool last = todo_.empty();
    const int fd = ::openat(folders_.back().get(), part.c_str(),
                            last ? flags_ | O_NOFOLLOW : O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (fd < 0 || last) return fd;
    folders_.emplace_back(fd);
    return kEntered;
  }

  int follow(const fs::path& target) {
    if (++links_ > kMostLinks) {
      errno = ELOOP;
      return -1;
    }
    if (target.is_relative()) return push(target) ? kEntered : out();
    std::error_code unknown;
    if (!push(target.lexically_relative(fs::canonical(below_, unknown)))) return out();
    while (folders_.size() > 1) folders_.pop_back();
    return kEntered;
  }

  const fs::path& below_;
  const int flags_;
  std::deque<Descriptor> folders_;  ///< from `below_` on
  std::vector<std::string> todo_;   ///< parts of the path, the next one last
  int links_ = 0;
};

}  // namespace

std::size_t MemorySource::read(std::uint64_t offset, std::span<std::byte> into) const {
  if (offset >= bytes_.size()) return 0;
  const ByteView found = bytes_.subspan(offset, std::min<std::uint64_t>(into.size(), bytes_.size() - offset));
  std::copy(found.begin(), found.end(), into.begin());
  return found.size();
}

int open_below(const fs::path& path, const fs::path& below, int flags) {
  return below.empty() ? ::open(path.c_str(), flags) : Resolution(below, flags).open(path);
}

int open_regular(const fs::path& path, Links links, const fs::path& below) {
  constexpr int kFlags = O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;
  const int fd = open_below(path, below, kFlags | (links == Links::kRefuse ? O_NOFOLLOW : 0));
  struct stat status {};
  if (fd >= 0 && ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) return fd;
  const int cause = errno;
  if (fd < 0) throw IoError(cause, path.string() + (cause == EXDEV ? leads_out(below) : " cannot be read"));
  ::close(fd);
  if (S_ISDIR(status.st_mode)) throw IoError(EISDIR, path.string() + ": this is a folder: name a file in it");
  throw IoError(ESPIPE, path.string() + ": is " + kind_of(status.st_mode) +
                            ", not a regular file: it is not read; put the file itself there");
}

std::uint64_t size_of(int fd) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) throw IoError(errno, "an open file has no size");
  return static_cast<std::uint64_t>(status.st_size);
}

FileSource::FileSource(const fs::path& path, Links links, const fs::path& below)
    : fd_(open_regular(path, links, below)), size_(size_of(fd_)) {}

FileSource::~FileSource() {
  ::close(fd_);
}

std::size_t FileSource::read(std::uint64_t offset, std::span<std::byte> into) const {
  std::size_t done = 0;
  while (done < into.size()) {
    const ssize_t n = ::pread(fd_, into.data() + done, into.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    done += static_cast<std::size_t>(n);
  }
  return done;
}

bool FileSource::being_written() const {
  if (::flock(fd_, LOCK_SH | LOCK_NB) != 0) return errno == EWOULDBLOCK;
  ::flock(fd_, LOCK_UN);
  return false;
}

}  // namespace rtd::io
