// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/fd_writing.hpp"

#include <fcntl.h>
#include <sys/uio.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <span>
#include <stdexcept>
#include <string>

#include "common/io/byte_sink.hpp"

namespace rtd::io {
namespace {

constexpr std::size_t kMaxParts = 16;

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
    case ELOOP:
      return "this is a symbolic link, which is not followed here: remove it, or name the file that it points to";
    case ENOTSUP:
      return "this is a device, a pipe or a socket, not a file: remove it or give another name";
    default:
      return "cannot write";
  }
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

void fail_writing(const std::filesystem::path& path, int error_number) {
  throw IoError(error_number, path.string() + ": " + reason(error_number));
}

int write_parts(int fd, std::initializer_list<ByteView> parts) {
  if (parts.size() > kMaxParts) throw std::logic_error("a byte sink takes at most 16 parts at once");
  std::array<iovec, kMaxParts> vectors;
  std::size_t count = 0;
  for (const ByteView part : parts) vectors[count++] = {const_cast<std::byte*>(part.data()), part.size()};
  return write_all(fd, std::span(vectors).first(count));
}

std::uint64_t size_of(std::initializer_list<ByteView> parts) {
  std::uint64_t size = 0;
  for (const ByteView part : parts) size += part.size();
  return size;
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : ".";
}

int open_folder_of(const std::filesystem::path& path) {
  const int fd = ::open(folder_of(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) fail_writing(path, errno == ENOTDIR ? ENOENT : errno);
  return fd;
}

void sync_folder(int folder_fd, const std::filesystem::path& folder) {
  // Some file systems cannot sync a folder and return EINVAL; they do not need it.
  if (::fsync(folder_fd) != 0 && errno != EINVAL) fail_writing(folder, errno);
}

}  // namespace rtd::io
