// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "common/io/byte_sink.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "common/io/fd_writing.hpp"

namespace rtd::io {

FileSink::FileSink(std::filesystem::path path, IfExists if_exists, Cached cached)
    : path_(std::move(path)), cached_(cached) {
  const int exclusive = if_exists == IfExists::kFail ? O_EXCL : 0;
  fd_ = ::open(path_.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC | O_NOFOLLOW | exclusive, 0644);
  if (fd_ < 0) fail_writing(path_, errno);
  // The content is deleted only when no other process writes the file.
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0 || ::ftruncate(fd_, 0) != 0) {
    const int error_number = errno;
    ::close(fd_);
    fail_writing(path_, error_number);
  }
}

FileSink::~FileSink() {
  ::close(fd_);
}

void FileSink::append(std::initializer_list<ByteView> parts) {
  if (broken_) fail_writing(path_, EIO);
  const std::uint64_t start = position();
  if (const int error_number = write_parts(fd_, parts); error_number != 0) {
    // Back to the last whole record. Where even that fails the file stays cut, and nothing must come behind the cut.
    broken_ = ::ftruncate(fd_, static_cast<off_t>(start)) != 0 || ::lseek(fd_, static_cast<off_t>(start), SEEK_SET) < 0;
    fail_writing(path_, error_number);
  }
  position_.store(start + size_of(parts), std::memory_order_release);
}

std::uint64_t FileSink::sync() {
  const std::uint64_t covered = position();
  if (::fdatasync(fd_) != 0) fail_writing(path_, errno);
  if (cached_ == Cached::kDrop)
    ::posix_fadvise(fd_, 0, static_cast<off_t>(covered), POSIX_FADV_DONTNEED);  // a hint only
  if (!folder_synced_.load()) sync_own_folder();
  return covered;
}

void FileSink::sync_own_folder() {
  const Descriptor folder(open_folder_of(path_));
  sync_folder(folder.get(), folder_of(path_));
  folder_synced_ = true;
}

}  // namespace rtd::io
