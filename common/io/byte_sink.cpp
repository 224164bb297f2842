// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/file.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "common/io/byte_sink.hpp"

namespace rtd::io {
namespace {

constexpr std::size_t kMostParts = 16;
using Parts = std::array<iovec, kMostParts>;

std::string reason(int error_number) {
  switch (error_number) {
    case EEXIST:
      return "it exists already: give another name or allow to replace it";
    case EWOULDBLOCK:
      return "another process is writing it";
    case ENOSPC:
    case EDQUOT:
      return "the disk is full";
    case EROFS:
      return "the folder is read-only";
    case EACCES:
      return "no permission to write in this folder";
    case ENOENT:
      return "there is no such folder";
    case EISDIR:
      return "this is a folder: name a file in it";
    case EFBIG:
      return "the file may not become larger (ulimit -f, or the file system)";
    default:
      return "cannot write";
  }
}

[[noreturn]] void fail(const std::filesystem::path& path, int error_number) {
  throw IoError(error_number, path.string() + ": " + reason(error_number));
}

/// writev until all is out; the parts shrink from the front. Returns 0 or the errno.
int write_all(int fd, std::span<iovec> parts) {
  while (!parts.empty()) {
    if (parts.front().iov_len == 0) {
      parts = parts.subspan(1);
      continue;
    }
    const ssize_t n = ::writev(fd, parts.data(), static_cast<int>(parts.size()));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    for (auto left = static_cast<std::size_t>(n); left > 0;) {
      iovec& part = parts.front();
      const std::size_t taken = std::min(left, part.iov_len);
      part.iov_base = static_cast<char*>(part.iov_base) + taken;
      part.iov_len -= taken;
      left -= taken;
      if (part.iov_len == 0) parts = parts.subspan(1);
    }
  }
  return 0;
}

}  // namespace

FileSink::FileSink(std::filesystem::path path, IfExists if_exists, Cached cached)
    : path_(std::move(path)), cached_(cached) {
  const int exclusive = if_exists == IfExists::kFail ? O_EXCL : 0;
  fd_ = ::open(path_.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC | exclusive, 0644);
  if (fd_ < 0) fail(path_, errno);
  // The content is deleted only when no other process writes the file.
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0 || ::ftruncate(fd_, 0) != 0) {
    const int error_number = errno;
    ::close(fd_);
    fail(path_, error_number);
  }
}

FileSink::~FileSink() {
  ::close(fd_);
}

void FileSink::append(std::initializer_list<ByteView> parts) {
  if (parts.size() > kMostParts) throw std::logic_error("a byte sink takes at most 16 parts at once");
  Parts vectors;
  std::size_t count = 0;
  std::uint64_t size = 0;
  for (const ByteView part : parts) {
    vectors[count++] = {const_cast<std::byte*>(part.data()), part.size()};
    size += part.size();
  }
  if (broken_) fail(path_, EIO);
  const std::uint64_t start = position();
  if (const int error_number = write_all(fd_, std::span(vectors).first(count)); error_number != 0) {
    // Back to the last whole record. Where even that fails the file stays cut, and nothing must come behind the cut.
    broken_ = ::ftruncate(fd_, static_cast<off_t>(start)) != 0 || ::lseek(fd_, static_cast<off_t>(start), SEEK_SET) < 0;
    fail(path_, error_number);
  }
  position_.store(start + size, std::memory_order_release);
}

std::uint64_t FileSink::sync() {
  const std::uint64_t covered = position();
  if (::fdatasync(fd_) != 0) fail(path_, errno);
  if (cached_ == Cached::kDrop)
    ::posix_fadvise(fd_, 0, static_cast<off_t>(covered), POSIX_FADV_DONTNEED);  // a hint only
  if (!folder_synced_.load()) sync_folder();
  return covered;
}

void FileSink::replace(const std::filesystem::path& path) {
  sync();
  if (::rename(path_.c_str(), path.c_str()) != 0) fail(path, errno);
  path_ = path;
  sync_folder();
}

/// The name of a new file lives in its folder, which fdatasync(2) of the file does not cover.
void FileSink::sync_folder() {
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) fail(folder, errno);
  const int result = ::fsync(fd);
  const int error_number = errno;
  ::close(fd);
  // Some file systems cannot sync a folder and return EINVAL; they do not need it.
  if (result != 0 && error_number != EINVAL) fail(folder, error_number);
  folder_synced_ = true;
}

}  // namespace rtd::io
