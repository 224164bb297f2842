// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/byte_source.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "common/io/byte_sink.hpp"

namespace rtd::io {

std::size_t MemorySource::read(std::uint64_t offset, std::span<std::byte> into) const {
  if (offset >= bytes_.size()) return 0;
  const ByteView found = bytes_.subspan(offset, std::min<std::uint64_t>(into.size(), bytes_.size() - offset));
  std::copy(found.begin(), found.end(), into.begin());
  return found.size();
}

FileSource::FileSource(const std::filesystem::path& path, Links links)
    : fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | (links == Links::kRefuse ? O_NOFOLLOW : 0))) {
  struct stat status {};
  int error_number = 0;
  if (fd_ < 0 || ::fstat(fd_, &status) != 0)
    error_number = errno;
  else if (!S_ISREG(status.st_mode))
    error_number = S_ISDIR(status.st_mode) ? EISDIR : ESPIPE;
  if (error_number != 0) {
    if (fd_ >= 0) ::close(fd_);
    throw IoError(error_number,
                  path.string() + (error_number == EISDIR ? ": this is a folder: name a file in it" : ": cannot read"));
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

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
